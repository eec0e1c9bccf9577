/* What a rig's own C has to offer for free runs, in its order: a new state in the motion x (psi psi' phi phi' omega_M omega_T, or what
 * the rig has of the kind), the motion of a state; one step; a command that has been there for ever; how far bristles stretch. */
void state_begin(const model_t *m, const double x[6], double t_s, state_t *s);
void state_motion(const state_t *s, double x[6]);
void plant_step(const model_t *m, state_t *s, const double gust[2], double dt);
void commands_settle(state_t *s, const double u_V[2]);
double bristle_width(const model_t *m, int axis);

/* Of all rigs. */
void predict(const model_t *m, int rows, const double *t_s, const double *u_V, const double *apparent, int window,
             double dt, double *out);
