"""How fast the closed loop is simulated: a plant and its table in, speeds beside those of the usual tools on the same equations out."""
