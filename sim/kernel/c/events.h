/* Steps in which an axis stops, turns, breaks away or meets a stop. */
#ifndef EVENTS_H
#define EVENTS_H

#include <stdint.h>

enum { EVENT_NONE, EVENT_REST, EVENT_LOWER, EVENT_UPPER, EVENT_BREAK_UP, EVENT_BREAK_DOWN, EVENT_KINK_UP, EVENT_KINK_DOWN };

#define MAX_EVENTS 16

/* A stretch of a step without events in it, and the event of `axis` that ended it; for EVENT_KINK_... `axis` counts the kinks. */
typedef struct {
    double t_s, h_s;
    int32_t axis, event;
} event_piece;

/* Advance one run by h_s through all events, at most MAX_EVENTS of them, after which axes at rest stay so for the rest.
 * `known` is the step as if there were no event in it, where somebody has computed that: the state at its end, then all that its stages saw.
 * `pieces` takes up to MAX_EVENTS + 1 stretches; returns how many there were. Both may be NULL. */
int events_advance(double *x, double *sign, double *move, double t_s, double h_s, const double *u, const double *c,
                   const double *known, event_piece *pieces);

/* What the event of `piece` does to the state and modes at its instant. */
void events_apply(double *x, double *sign, double *move, double t_s, const double *u, const double *c, event_piece piece);

/* Decide for every axis at its present state whether it moves or is held, and put it back between its stops. */
void events_settle(double *x, double *sign, double *move, double t_s, const double *u, const double *c);

#endif
