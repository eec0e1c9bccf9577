/* The rig of the sealed benchmark: what it is made of, what may be wrong with it, where it stands, what a run takes and gives.
 * Index 0 is the main rotor or the elevation axis, index 1 the tail rotor or the azimuth axis. SI units. A zero switches an effect off.
 * Only declarations stand here: the same text is read by the compiler and by cffi. */
typedef struct {
    double damping[2][3];      /* rotor damping, ascending powers of |omega| */
    double drive[2];           /* rad s^-2 V^-1 */
    double thrust[2][5];       /* N, ascending powers of |omega| */
    double arm_m[2];
    double inertia[2];         /* kg m^2 */
    double gravity_Nm;
    double viscous[2];         /* N m s */
    double coulomb_Nm[2];
    double gyro;               /* N m s^2: azimuth rate times main speed on elevation */
    double reaction;           /* N m s: main speed on azimuth */
    double centrifugal;        /* kg m^2, signed */
    double u_min_V[2], u_max_V[2];
    double stop_rad[2];
    double resolution_rad[2];
} rig_t;

typedef struct {
    /* drivers */
    double dead_V[2], dead_width_V[2], limit_V[2], sag[2], delay_s[2], slew_V_s[2], step_V[2], lag_s[2], play_V[2], current_V[2];
    /* rotors */
    double warm[2], warm_time_s[2], dry[2], inflow[2];
    double ground, ground_height_rad, reverse, reverse_width_rad_s, downwash, stall_rad_s;
    /* axes */
    double stribeck_Nm[2], stribeck_rad_s[2], drag[2], drag_floor_rad_s[2], spring[2], spring_zero_rad[2], hardening[2];
    double asymmetry_Nm[2], cable_Nm_rad[2], cable_slip_rad[2], spin_inertia[2], pulse_Nm[2], pulse_start_s[2], pulse_s[2];
    double draught_Nm[2], draught_rad_s[2], draught_phase[2], grease[2], grease_time_s[2];
    double centre_Nm, weight, weight_time_s, weight_ramp_s, tail_to_elevation_m, bumper_Nm_rad, bumper_rad, load_friction_m;
    double tilt_Nm, tilt_rad, gyro_azimuth, wind, wind_m_s, wind_rad, reaction_quadratic, inertia_cosine2, coriolis;
    double detent_Nm, detent_count;
    /* sensors */
    double flex[2], flex_rad_s[2], flex_zeta[2], offset_rad[2], scale_error[2], count_rad[2], sensor_delay_s[2], sensor_lag_s[2];
    double backlash_rad[2], cyclic_rad[2], cyclic_count[2], cyclic_phase[2], slip_rad[2], slip_time_s[2], cross[2];
} effects_t;

typedef struct {
    double time_s[64], u_V[64];  /* commands under way, oldest first at `tail` */
    int head, tail;
    double now_V;
} pipe_t;

typedef struct {
    double t_s;
    double angle[2], rate[2], omega[2];
    double middle[2], spin[2];                     /* rotor speed halfway through the last step, and its change per second */
    double bristle[2], cable[2];
    double slewed_V[2], lagged_V[2], played_V[2], load_V;
    pipe_t pipe[2];
    double warm_factor[2], grease_factor[2], gravity_factor, pulse_Nm[2], draught_Nm[2];
    double flex[2], flex_rate[2];
    double read[2], read_rate[2];                  /* what the encoder shaft shows, before counting */
    double lagged[2], played[2];
    double past[2][4096], past_rate[2][4096];
    int past_index;
} state_t;

typedef struct {
    double angle[2], rate[2], speed[2], sum[2];    /* tracked angle and rate, modelled rotor speed, integral of the error */
} pilot_state_t;

typedef struct {
    int points;
    double from_rad, step_rad;
    double gain[2][16][4];     /* per axis and elevation: integral, angle, rate, rotor speed */
    double rest_V[2][16], rest_rad_s[2][16];
    double track_rad_s;        /* bandwidth of the rate filter */
} pilot_t;

typedef struct {
    int rows, settle;          /* rows in all; the first `settle` are flown before the log's time 0 */
    const int *substeps;       /* (rows): steps of 100 us until the next row */
    const double *reference;   /* (rows, 2) */
    const double *dither_V;    /* (rows, 2) */
    const double *gust_Nm;     /* (rows, 10, 2) */
    const unsigned char *lost; /* (rows): the command of this row never arrives */
} flight_t;

typedef struct {
    double *t_s, *u_V, *y_rad, *exact_rad, *apparent, *shadow; /* (rows) (rows,2) (rows,2) (rows,2) (rows,6) (rows,shadows,2) */
    int at_stop;               /* sub-steps on an elevation stop */
    int failed;                /* 1: a number was lost */
} record_t;

void rig_step(const rig_t *rig, const effects_t *fx, state_t *s, const double gust_Nm[2], double dt);
void rig_slow(const effects_t *fx, state_t *s);
void rig_command(const effects_t *fx, state_t *s, const double u_V[2]);
double rig_damping(const rig_t *rig, int rotor, double speed);
double rig_thrust(const rig_t *rig, int rotor, double speed);
double driver_output(const rig_t *rig, const effects_t *fx, state_t *s, int rotor, double dt);
void sensor_step(const effects_t *fx, state_t *s, double dt);
int sensor_moves(const effects_t *fx);
void sensor_reset(const effects_t *fx, state_t *s);
double sensor_count(const rig_t *rig, const effects_t *fx, const state_t *s, int axis);
void pilot_reset(const pilot_t *pilot, const double y_rad[2], pilot_state_t *p);
void pilot_step(const pilot_t *pilot, const rig_t *nominal, const double r_rad[2], const double y_rad[2], const double dither_V[2],
                double period_s, pilot_state_t *p, double u_V[2]);
void fly(const rig_t *rig, const effects_t *fx, const rig_t *nominal, const pilot_t *pilot, const flight_t *flight, const double start[6],
         int shadows, const rig_t *shadow_rig, const effects_t *shadow_fx, const unsigned char *mode, int window, record_t *out);
void predict(const rig_t *rig, int rows, const double *t_s, const double *u_V, const double *apparent, int window, double dt, double *out);
