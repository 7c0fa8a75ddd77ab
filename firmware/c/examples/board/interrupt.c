/* An interrupt that asks for the live estimate, wherever the program is. Each call returns the
 * estimate, or that the estimator is busy; the cells of the program stay the same. */

#include "road_grade.h"

#include <stdlib.h>

extern GradeEstimator *estimator;

void tick(void);
int unmet(void);

static unsigned int answers = 0U;
static unsigned int refusals = 0U;

/* Called by the system timer some thousand times a second, wherever the program is. */
void tick(void) {
    GradeLiveEstimate live;
    if (estimator == NULL) {
        return;
    }
    switch (grade_live(estimator, &live)) {
    case GRADE_STATUS_OK:
    case GRADE_STATUS_NOTHING:
        answers++;
        break;
    case GRADE_STATUS_BUSY:
        refusals++;
        break;
    default:
        _Exit(102);
    }
}

/* Returns 0 if the interrupt met calls of the program, and also came between them. */
int unmet(void) {
    return ((answers > 0U) && (refusals > 0U)) ? 0 : 103;
}
