"""A signal on its way from command to rotor or from axis to reading in; the signal behind each stage with memory out."""
