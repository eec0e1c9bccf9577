/* Where the first rig stands, what its bearings are made of, and its controller. */
typedef struct {
    double width[2];           /* rad, displacement of the bristles at full slip: far below an encoder count, as in a hard bearing */
} bearing_t;

typedef struct {
    double t_s;
    double angle[2], rate[2], omega[2];
    double middle[2], spin[2];                     /* rotor speed halfway through the last step, and its change per second */
    double bristle[2], cable[2];
    double slewed_V[2], lagged_V[2], played_V[2], load_V;
    line_t line[2];
    double warm_factor[2], grease_factor[2], gravity_factor, pulse_Nm[2], draught_Nm[2];
    double flex[2], flex_rate[2];
    double read[2], read_rate[2];                  /* what the encoder shaft shows, before counting */
    double lagged[2], played[2];
    past_t past[2];
} state_t;

typedef struct {
    double angle[2], rate[2], speed[2], sum[2];    /* tracked angle and rate, modelled rotor speed, integral of the error */
} control_state_t;

typedef struct {
    int points;
    double from_rad, step_rad;
    double gain[2][16][4];     /* per axis and elevation: integral, angle, rate, rotor speed */
    double rest_V[2][16], rest_rad_s[2][16];
    double track_rad_s;        /* bandwidth of the rate filter */
    double period_s;
} control_t;

double driver_output(const rig_t *rig, const effects_t *fx, state_t *s, int rotor, double dt);
void rig_slow(const effects_t *fx, state_t *s);
void sensor_step(const effects_t *fx, state_t *s, double dt);
int sensor_moves(const effects_t *fx);
void sensor_reset(const effects_t *fx, state_t *s);
