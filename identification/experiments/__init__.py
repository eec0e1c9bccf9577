"""The nine experiments of seed 000: each performed on a simulated rig, and each record made ready for the estimator."""
