/* Which frames were lost, all together: the likeliest histories of losses side by side, row after row, a beam of them kept.
 *
 * Answers of neighbouring frames overlap and look alike, so that frames judged one after another, each beside what is supposed of the
 * others, settle where many a loss stands at a neighbour's place. A history that is wrong there shows it within some rows.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lost_answer.h"

#define KEPT 96
#define HOPELESS 40.0 /* nats behind the likeliest */
#define LEAST_POWER 4.0 /* squared answer of a loss that the readings tell from none at two standard deviations */
#define MEMORY 60 /* rows after which what remains of a decision is settled; bits of a history */
static const uint64_t RECENT = ((uint64_t)1 << MEMORY) - 1;

typedef struct {
    double weight, held[MAX_DRIVES]; /* log likelihood; what arrived last */
    uint64_t history;                /* one bit a row, the last row's lowest */
    double *explained;               /* (apart, slots), by row modulo apart: of the innovations to come, by the losses so far */
} strand;

typedef struct {
    double weight;
    uint64_t history;
    int from, lost;
} offspring;

static int likelier(const void *one, const void *other)
{
    const double a = ((const offspring *)one)->weight, b = ((const offspring *)other)->weight;
    return (a < b) - (a > b);
}

/* What would have arrived other than was sent if the row's frame was lost; whether the readings could tell. */
static int tells(const loss_request *r, const strand *s, int64_t row, double *held)
{
    const int64_t lags = r->rows - row < r->apart ? r->rows - row : r->apart;
    double power = 0.0;
    for (int64_t d = 0; d < r->drives; d++)
        held[d] = s->held[d] - r->u[row * r->inputs + r->column[d]];
    if (!r->judged[row])
        return 0;
    for (int64_t lag = 0; lag < lags && power < LEAST_POWER; lag++)
        for (int64_t slot = 0; slot < r->slots; slot++) {
            const double a = answer(r, row, lag, slot, held);
            power += a * a;
        }
    return power >= LEAST_POWER;
}

static double misfit(const loss_request *r, const strand *s, int64_t row, const double *held)
{
    double sum = 0.0;
    for (int64_t slot = 0; slot < r->slots; slot++) {
        double w = r->left[row * r->slots + slot] - s->explained[row % r->apart * r->slots + slot];
        if (held)
            w -= answer(r, row, 0, slot, held);
        sum += 0.5 * w * w;
    }
    return sum;
}

/* Both futures of each strand, or the one that it has; returns their number, and whether any had two in `open`. */
static int branch(const loss_request *r, const strand *now, int count, int64_t row, double share, offspring *found, double *open)
{
    int number = 0;
    *open = 0.0;
    for (int i = 0; i < count; i++) {
        double held[MAX_DRIVES];
        const int told = tells(r, now + i, row, held);
        *open = told ? 1.0 : *open;
        const uint64_t past = now[i].history << 1;
        const double arrived = told ? log(1.0 - share) : 0.0;
        found[number++] = (offspring){now[i].weight + arrived - misfit(r, now + i, row, 0), past, i, 0};
        if (told)
            found[number++] = (offspring){now[i].weight + log(share) - misfit(r, now + i, row, held), past | 1, i, 1};
    }
    return number;
}

/* The likeliest of them, those of one recent history as one; returns their number. */
static int choose(offspring *found, int number)
{
    int kept = 0;
    qsort(found, (size_t)number, sizeof *found, likelier);
    for (int i = 0; i < number && found[i].weight > found[0].weight - HOPELESS; i++) {
        int same = 0;
        while (same < kept && ((found[same].history ^ found[i].history) & RECENT))
            same++;
        if (same < kept)
            found[same].weight += log1p(exp(found[i].weight - found[same].weight));
        else if (kept < KEPT)
            found[kept++] = found[i];
    }
    return kept;
}

static void follow(const loss_request *r, const strand *parent, const offspring *own, int64_t row, strand *child)
{
    const int64_t lags = r->rows - row < r->apart ? r->rows - row : r->apart;
    double held[MAX_DRIVES];
    memcpy(child->explained, parent->explained, sizeof(double) * (size_t)(r->apart * r->slots));
    memset(child->explained + row % r->apart * r->slots, 0, sizeof(double) * (size_t)r->slots);
    child->weight = own->weight;
    child->history = own->history;
    for (int64_t d = 0; d < r->drives; d++) {
        const double sent = r->u[row * r->inputs + r->column[d]];
        child->held[d] = own->lost ? parent->held[d] : sent;
        held[d] = child->held[d] - sent;
    }
    for (int64_t lag = 1; own->lost && lag < lags; lag++)
        for (int64_t slot = 0; slot < r->slots; slot++)
            child->explained[(row + lag) % r->apart * r->slots + slot] += answer(r, row, lag, slot, held);
}

/* The share of the strands' likelihood in which the frame `ago` rows before the last one was lost; the usual share where none could tell. */
static void settle(const loss_request *r, const strand *now, int count, int64_t row, int ago, double share, double *lost)
{
    double sum = 0.0, all = 0.0;
    for (int i = 0; i < count; i++) {
        const double weight = exp(now[i].weight - now[0].weight);
        all += weight;
        sum += (now[i].history >> ago & 1) ? weight : 0.0;
    }
    lost[row - ago] = lost[row - ago] > 0.0 ? sum / all : r->judged[row - ago] ? share : 0.0;
}

/* The probability that each frame was lost (rows), where the innovations `left` are those without any loss. */
int likely_losses(const loss_request *r, double share, double *lost)
{
    const size_t window = (size_t)(r->apart * r->slots);
    double *const room = calloc(2 * KEPT * window, sizeof *room);
    strand strands[2][KEPT], *now = strands[0], *next = strands[1];
    offspring found[2 * KEPT];
    int count = 1;
    if (!room)
        return 0;
    for (int i = 0; i < KEPT; i++) {
        strands[0][i].explained = room + (size_t)i * window;
        strands[1][i].explained = room + (size_t)(KEPT + i) * window;
    }
    now[0].weight = 0.0;
    now[0].history = 0;
    for (int64_t d = 0; d < r->drives; d++)
        now[0].held[d] = r->u[r->column[d]];
    lost[0] = 0.0;
    for (int64_t row = 1; row < r->rows; row++) {
        count = choose(found, branch(r, now, count, row, share, found, lost + row));
        for (int i = 0; i < count; i++)
            follow(r, now + found[i].from, found + i, row, next + i);
        strand *const last = now;
        now = next;
        next = last;
        if (row >= MEMORY)
            settle(r, now, count, row, MEMORY - 1, share, lost);
    }
    for (int ago = 0; ago < MEMORY - 1 && ago < r->rows - 1; ago++)
        settle(r, now, count, r->rows - 1, ago, share, lost);
    free(room);
    return 1;
}
