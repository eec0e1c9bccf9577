/* The second rig: what it is made of, what may be wrong with it, where it stands, what a run takes and gives.
 * Index 0 is the main rotor or the elevation axis, index 1 the tail rotor or the azimuth axis. SI units.
 * A zero switches an effect off.
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
    int law[2];                /* 0 rounded, 1 presliding (Dahl), 2 stick-slip (Karnopp) */
    double width[2];           /* rad/s of the rounding, rad of presliding, rad/s of the band that counts as rest */
} bearing_t;

typedef struct {
    /* drivers */
    double dead_V[2], dead_knee[2], dead_skew[2], limit_V[2], limit_knee[2], sag[2], supply_s;
    double delay_s[2], delay_spread[2];
    double slew_V_s[2], slew_skew[2], step_V[2], step_hold[2], lag_s[2], lag_split[2];
    double bias_V[2], cross[2], dip[2], dip_every_s[2], dip_long_s[2], dip_spread[2];
    /* rotors */
    double warm[2], warm_fast_s[2], warm_slow_s[2], warm_share[2], dry[2], dry_round_rad_s[2], seize[2], clutch_rad_s2;
    double ground, ground_reach, flutter, flutter_rad_s, flutter_width_rad_s, stale, stale_s, flap;
    double reverse, reverse_rad_s, downwash, downwash_power, chip, chip_time_s;
    double vortex, vortex_rad_s, vortex_width_rad_s;
    /* bearings */
    double stribeck_Nm[2], stribeck_rad_s[2], asymmetry_Nm[2], spot_Nm, spot_rad, spot_width_rad, brush_Nm, brush_rad;
    /* axes */
    double drag[2], drag_power[2], spring[2], spring_zero_rad[2], spring_slack[2], spring_growth[2];
    double spin_inertia[2], spin_soft_s[2];
    double pulse_Nm[2], pulse_start_s[2], pulse_s[2], pulse_rise[2], knock_Nm[2], knock_every_s[2], drift_Nm_s[2];
    double mass_share[2], mass_rad_s[2], mass_zeta[2], mass_reads[2];
    double centre_rad, centre_droop, weight, weight_time_s, weight_slide_s, tail_lift, tail_lift_power;
    double maxwell_Nm_rad, maxwell_s;
    double lean_Nm, lean_rad, tilt_Nm, tilt_rad, gyro_azimuth, gyro_cant_rad, magnet_Nm, magnet_rad, magnet_width_rad;
    double eddy_Nms, eddy_rad_s;
    /* sensors */
    double offset_rad[2], offset_swing[2], scale_error[2], scale_bend[2], count_rad[2], count_hold[2];
    double sensor_delay_s[2], sensor_spread[2], sensor_lag_s[2], sensor_split[2], backlash_rad[2], backlash_split[2];
    double pickup_rad_V[2], missed[2], missed_rad_s[2], wander_rad_s[2];
} effects_t;

typedef struct {
    double sent_s[64], luck[64], u_V[64];          /* commands under way, oldest first at `tail` */
    int head, tail;
    double now_V;
} line_t;

typedef struct {
    double t_s;
    /* psi psi' phi phi' omega_M omega_T, then angle and rate of the second mass on elevation and on azimuth,
     * then followers of the tail's and of the main rotor's speed */
    double x[12];
    int held[2];               /* a bearing that sticks */
    double bristle[2];         /* presliding, rad */
    line_t line[2];
    int sent;                  /* commands so far */
    double stepped_V[2], slewed_V[2], first_V[2], second_V[2], load_V, volts[2];
    double warm_factor[2], dip_factor[2], gravity_factor, chip_factor, outer_Nm[2];
    double maxwell_rad, stale_N;
    double read[2], read_rate[2];                  /* what the encoder shaft shows, before counting */
    double filtered[2][2], played[2][2], missed_rad[2], counted[2];
    double past[2][1024], past_rate[2][1024];
    int past_index;
} state_t;

typedef struct {
    int kind;                  /* 0 PID, 1 cascade of angle and rate, 2 state feedback with integral */
    /* PID: angle, integral, rate; cascade: angle, rate, integral of rate; feedback: angle, integral, rate, speed */
    double gain[2][4];
    /* voltage and rotor speed at rest, ascending powers of the elevation's reference */
    double feed_V[2][3], feed_rad_s[2][3];
    double rate_filter_s, rate_limit_rad_s;
    double period_s;
} control_t;

typedef struct {
    double last[2], rate[2], sum[2], speed[2];
} control_state_t;

typedef struct {
    int rows, settle;          /* rows in all; the first `settle` are flown before the log's first row */
    double step_s;
    const int *steps;          /* (rows): steps until the next row */
    const double *reference;   /* (rows, 2) */
    const double *dither_V;    /* (rows, 2) */
    int slots, slot_steps;     /* gusts per row, steps for which each lasts */
    const double *gust;        /* (rows, slots, 2) rad/s^2 */
    const unsigned char *lost; /* (rows): the command of this row never arrives */
} flight_t;

typedef struct {
    /* (rows) (rows,2) (rows,2) (rows,2) (rows,6) (rows,shadows,2) */
    double *t_s, *u_V, *y_rad, *exact_rad, *apparent, *shadow;
    int at_stop;               /* rows on an elevation stop */
    int failed;                /* 1: a number was lost */
} record_t;

double scatter(int key);
double rounded_drop(double v, double drop, double width);
double rotor_damping(const rig_t *rig, int rotor, double speed);
double main_thrust(const rig_t *rig, const effects_t *fx, double speed, double psi_rad, double stale_N);
double tail_thrust(const rig_t *rig, const effects_t *fx, double speed, double main_speed, double rate,
                   double chip_factor);
void rotor_brake(const effects_t *fx, state_t *s, double dt);
void weather(const effects_t *fx, state_t *s);
void line_send(state_t *s, const double u_V[2]);
void line_settle(state_t *s, const double u_V[2]);
void driver_step(const rig_t *rig, const effects_t *fx, state_t *s, double dt);
void bearing_grip(const rig_t *rig, const bearing_t *bearing, const effects_t *fx, state_t *s, const double gust[2]);
void bearing_step(const rig_t *rig, const bearing_t *bearing, const effects_t *fx, state_t *s, double dt);
void slope(const rig_t *rig, const effects_t *fx, const state_t *s, const double x[12], const double gust[2],
           double dx[12]);
void plant_step(const rig_t *rig, const bearing_t *bearing, const effects_t *fx, state_t *s, const double gust[2],
                double dt);
int sensor_moves(const effects_t *fx);
void sensor_step(const effects_t *fx, state_t *s, double dt);
void sensor_rest(const effects_t *fx, state_t *s);
double sensor_count(const rig_t *rig, const effects_t *fx, state_t *s, int axis);
void control_start(const control_t *c, const double r_rad[2], const double y_rad[2], control_state_t *k);
void control_step(const control_t *c, const rig_t *nominal, const double r_rad[2], const double y_rad[2],
                  const double dither_V[2], control_state_t *k, double u_V[2]);
void fly(const rig_t *rig, const bearing_t *bearing, const effects_t *fx, const rig_t *nominal,
         const control_t *control, const flight_t *flight, const double start[6], int shadows,
         const rig_t *shadow_rig, const effects_t *shadow_fx, const unsigned char *mode, int window, record_t *out);
void predict(const rig_t *rig, const bearing_t *bearing, int rows, const double *t_s, const double *u_V,
             const double *apparent, int window, double dt, double *out);
