/* True parameters, and how the rig stands in an experiment; SI units, names of the paper. */
#ifndef RIG_H
#define RIG_H

typedef struct {
    double l_M, l_T, p_bM[3], K_M, p_bT[3], K_T, p_FM[5], p_FT[5], J_E, tau_gE, b_vE, b_cE, K_E, J_A, b_vA, b_cA, K_A, g, Psi_lim, Phi_lim,
        cf_sign, cf_length;
} rig_truth;

typedef struct {
    double mount_rad; /* gravity acts on the elevation by cos(Psi + mount) */
    double turned;    /* 1: the azimuth's axis lies level, and gravity acts on it */
    int elevation_locked, azimuth_locked, hand_turned;
    double hand_rad[3], hand_rad_s[3], hand_phase_rad[3];
    double weight_kg, lever_m, lever_rad; /* a counterweight at the tail */
} rig_setup;

/* x: [omega_M, psi, psi', omega_T, phi, phi', turns of both rotors in rad], in place; history (samples, 8) before each sample's inputs u
 * (samples, 2) act for a period in `steps` steps. */
void rig_run(const rig_truth *p, const rig_setup *s, int samples, int steps, double t_s, double period_s, const double *u, double *x,
             double *history);

#endif
