/* A rig's own laws of a driver's stages, in the order of the signal, and all of them in a row. */
double slewed(const effects_t *fx, state_t *s, int i, double u, double dt);
double lagged(const effects_t *fx, state_t *s, int i, double u, double dt);
double dead_band(const effects_t *fx, int i, double u);
double limited(const effects_t *fx, int i, double u);
double sagged(const effects_t *fx, const state_t *s, int i, double u);
double stages(const effects_t *fx, state_t *s, int i, double u, double dt);
