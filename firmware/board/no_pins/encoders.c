/* In place of a chip's file where the table's loops have no pins: angles come over the line. */
#include "board.h"

void encoders_start(encoder_counts *self)
{
    *self = (encoder_counts){0};
}

encoder_counts encoders_read(encoder_counts *self)
{
    return *self;
}
