/* What every rig of the sealed benchmark is made of. Index 0 is the main rotor or the elevation axis, index 1 the tail rotor or
 * the azimuth axis. SI units. Only declarations stand in a header: the same text is read by the compiler and by cffi. */
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
    double angle[1024], rate[1024];                /* what an encoder shaft showed, one entry per step */
    int index;
} past_t;

double rotor_damping(const rig_t *rig, int rotor, double speed);
void past_fill(past_t *past, double angle, double rate);
void past_delay(past_t *past, double delay_s, double dt, double *angle, double *rate);
