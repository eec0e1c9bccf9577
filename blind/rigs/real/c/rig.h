/* The third kind of rig: several plants behind one bench. Axis and input 0 come first; a plant with one of each leaves the other
 * alone. SI units. Only declarations stand here: the same text is read by the compiler and by cffi.
 * The numbers of a plant bear the names of its plant file. */
typedef struct {
    double l_M, l_T, p_bM[3], K_M, p_bT[3], K_T, p_FM[5], p_FT[5], J_E, tau_gE, b_vE, b_cE, K_E, J_A, b_vA, b_cA, K_A, g;
    double u_min, u_max, uT_min, uT_max, Psi_lim, Phi_lim, cf_sign, cf_length;
} ce150_t;

typedef struct {
    double m, l, c, K, g, u_max;
} aeroshield_t;

typedef struct {
    double M, F_v, F_c, offset, gtau, u_max;
} emps_t;

typedef struct {
    double dt, me, dx, mpa, lt, mrod, ry, my, g, K_omega, Kmt, Ktt, Kmp, Ktp, d1, d2, u_max;
} quanser_aero_t;

typedef struct {
    double omega_n, xi, mu, tau;
} antx_2dof_drone_t;

typedef struct {
    double R, L, K, J, b, tau_c, u_max;
} dc_motor_t;

typedef struct {
    int plant;                 /* 0 ce150, 1 aeroshield, 2 emps, 3 quanser_aero, 4 antx_2dof_drone, 5 dc_motor */
    int axes, inputs, outputs; /* an output more than axes: the rate of axis 0, by a gyro */
    double low_V[2], high_V[2], stop[2];           /* limits of the inputs; a stop at +-, 0: none */
    double lost;               /* an angle at which the run counts for nothing */
    ce150_t ce150;
    aeroshield_t aeroshield;
    emps_t emps;
    quanser_aero_t quanser_aero;
    antx_2dof_drone_t antx_2dof_drone;
    dc_motor_t dc_motor;
} rig_t;
