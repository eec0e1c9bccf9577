/* Where the second rig stands, what its bearings are made of, and its controller. */
typedef struct {
    int law[2];                /* 0 rounded, 1 presliding (Dahl), 2 stick-slip (Karnopp) */
    double width[2];           /* rad/s of the rounding, rad of presliding, rad/s of the band that counts as rest */
} bearing_t;

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
    past_t past[2];
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

double scatter(int key);
double rounded_drop(double v, double drop, double width);
double main_thrust(const rig_t *rig, const effects_t *fx, double speed, double psi_rad, double stale_N);
double tail_thrust(const rig_t *rig, const effects_t *fx, double speed, double main_speed, double rate,
                   double chip_factor);
void rotor_brake(const effects_t *fx, state_t *s, double dt);
void weather(const effects_t *fx, state_t *s);
void driver_step(const rig_t *rig, const effects_t *fx, state_t *s, double dt);
void bearing_grip(const rig_t *rig, const bearing_t *bearing, const effects_t *fx, state_t *s, const double gust[2]);
void bearing_step(const rig_t *rig, const bearing_t *bearing, const effects_t *fx, state_t *s, double dt);
void slope(const rig_t *rig, const effects_t *fx, const state_t *s, const double x[12], const double gust[2],
           double dx[12]);
int sensor_moves(const effects_t *fx);
void sensor_step(const effects_t *fx, state_t *s, double dt);
void sensor_rest(const effects_t *fx, state_t *s);
