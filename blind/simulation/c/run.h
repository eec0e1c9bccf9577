/* What a run takes and gives, whichever rig flies it, and what a rig's own C has to offer for it. */
typedef struct {
    rig_t rig;
    bearing_t bearing;
    effects_t effects;
} model_t;

typedef struct {
    int rows, settle;          /* rows in all; the first `settle` are flown before the log's first row */
    double step_s;
    const int *steps;          /* (rows): steps until the next row */
    const double *reference;   /* (rows, 2) rad */
    const double *dither_V;    /* (rows, 2) */
    int gusts, gust_steps;     /* gusts per row, steps for which each lasts in a row that comes on time */
    const double *gust;        /* (rows, gusts, 2), in the rig's own unit */
    const unsigned char *lost; /* (rows): the command of this row never arrives */
} inputs_t;

typedef struct {
    /* (rows) (rows,2) (rows,2) (rows,2) (rows,6) (rows,shadows,2) */
    double *t_s, *u_V, *y_rad, *exact_rad, *apparent, *shadow;
    int at_stop;               /* rows on an elevation stop */
    int failed;                /* 1: a number was lost */
} record_t;

/* A rig's own besides what free runs need, in its order: a state put into a motion; all steps of a row; a command that is sent; the
 * number that an encoder gives; the controller. */
void state_place(const model_t *m, const double x[6], state_t *s);
void state_advance(const model_t *m, state_t *s, const inputs_t *in, int row, int windy);
void commands_send(state_t *s, const double u_V[2]);
double sensor_count(const rig_t *rig, const effects_t *fx, state_t *s, int axis);
void control_start(const control_t *c, const double r_rad[2], const double y_rad[2], control_state_t *k);
void control_step(const control_t *c, const rig_t *nominal, const double r_rad[2], const double y_rad[2],
                  const double dither_V[2], control_state_t *k, double u_V[2]);

/* Of all rigs. */
void fly(const model_t *own, const rig_t *nominal, const control_t *control, const inputs_t *in, const double start[6],
         int shadows, const model_t *other, const unsigned char *mode, int window, record_t *out);
