"""What every rig's simulation takes and gives: a rig with settings of effects in, the record of a run out."""
