/* What each command of the host does to the control path. */
#ifndef COMMANDS_H
#define COMMANDS_H

#include "path.h"

path_demand command_obey(path_state *self, const link_frame *frame);

#endif
