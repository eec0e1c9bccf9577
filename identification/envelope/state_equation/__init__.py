"""From flights of one condition to A and B of dx/dt = A x + B u, and to the initial states from which it runs freely."""
