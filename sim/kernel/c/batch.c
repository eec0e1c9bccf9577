/* Many runs, LANES at a time. */
#define LANES BATCH_LANES
#include "run.h"

#include "exports.h"

void run_batch(const run_request *request)
{
    for (int64_t first = 0; first < request->runs; first += LANES)
        run_group(request, first);
}
