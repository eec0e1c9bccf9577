typedef struct {
    rig_t rig;
    effects_t effects;
    int law;                   /* of dry friction: 0 arc tangent, 1 Dahl, 2 LuGre */
    double width[2];           /* rad/s (m/s) of the arc tangent, rad (m) of the bristles */
    double filter_s[2];        /* of the readings, before counting; 0: none */
    int locked[2];             /* an axis that is held */
} model_t;

typedef struct {
    double t_s;
    double x[6];               /* angle, rate of axis 0, of axis 1; speeds of rotors 0 and 1, or what else lags: two filters, a current.
                                * Where a gyro measures axis 0 its rate stands in the place of the second angle, as it is read there. */
    double bristle[2];
    line_t line[2];
    double slewed_V[2], lagged_V[2], played_V[2], load, volts[2];      /* load: of the supply, in 10 V */
    double seen[2], seen_rate[2], shown[2], slow[2], held[2], filtered[2], lost_angle[2];
    double past[1024][2];      /* angles as shown, one entry per step */
    int now;
} state_t;

typedef struct {
    int rows, settle, closed;
    double step_s;
    int steps;                 /* per row */
    double period_s;
    double gain[2][3];         /* closed: of angle, its integral, its rate, in V */
    double rate_filter_s;
    double bit_V[2];           /* step of a command */
    double resolution[2];
    const double *reference;   /* (rows, 2) */
    const double *base_V;      /* (rows, 2): the whole command of an open loop, what is added to the law's in a closed one */
    const double *push;        /* (rows + 1, 2): acceleration by what disturbs the axes */
    const double *misread;     /* (rows, 2): error of the readings before counting */
    const unsigned char *lost;
} run_t;

typedef struct {
    double *t_s, *u_V, *y, *exact, *apparent, *shadow;     /* (rows) (rows,2) (rows,2) (rows,2) (rows,6) (rows,shadows,2) */
    int at_stop, failed;
} record_t;

void driver_step(const model_t *m, state_t *s, double dt);
void commands_send(state_t *s, const double u_V[2]);
void torques(const model_t *m, const state_t *s, const double x[6], double torque[2], double inertia[2], double spin[2]);
double dry_level(const model_t *m, const state_t *s, int axis, double rate);
double shared_torque(const model_t *m, const state_t *s, int axis, double angle, double rate);
double motor_factor(const model_t *m, const state_t *s, int rotor);
void sensor_rest(const model_t *m, state_t *s);
void sensor_step(const model_t *m, state_t *s, double dt);
double sensor_count(const model_t *m, double shown, double resolution, int axis);
void state_place(const model_t *m, const double x[6], state_t *s);
void fly(const model_t *own, const run_t *run, const double start[6], int shadows, const model_t *other,
         const unsigned char *mode, int window, record_t *out);
