/* Runs a recorded drive through the estimator, as the Rust image of the emulated board does:
 * reads drive.bin, writes cells.bin (docs/formats.md, and firmware/src/exchange for both forms).
 * The same file is compiled for hosts and for the board. */

#include "road_grade.h"

#include <stdio.h>
#include <string.h>

enum { FRAME_BYTES = 24, CELL_BYTES = 52 };

/* Static: zero at the start, aligned, and too large for the stack of a controller. */
static union {
    uint64_t alignment;
    uint8_t bytes[GRADE_ESTIMATOR_BYTES];
} memory;

static uint8_t vehicle[GRADE_PACKED_VEHICLE_BYTES];

/* An interrupt may ask it as well. */
extern GradeEstimator *estimator;
GradeEstimator *estimator = NULL;

static uint32_t word_at(const uint8_t *bytes) {
    return (uint32_t)bytes[0] | ((uint32_t)bytes[1] << 8) | ((uint32_t)bytes[2] << 16)
           | ((uint32_t)bytes[3] << 24);
}

static uint8_t *put_word(uint8_t *bytes, uint32_t word) {
    for (unsigned int i = 0U; i < 4U; i++) {
        bytes[i] = (uint8_t)(word >> (8U * i));
    }
    return bytes + 4;
}

static uint8_t *put_float(uint8_t *bytes, float number) {
    uint32_t word;
    (void)memcpy(&word, &number, sizeof word);
    return put_word(bytes, word);
}

static uint8_t *put_uncertain(uint8_t *bytes, GradeUncertain known) {
    return put_float(put_float(bytes, known.value), known.sigma);
}

static bool write_cell(FILE *file, const GradeFinishedCell *cell) {
    const GradeEnd *end = &cell->end;
    const bool flags[8] = {end->condition.shifting,
                           end->condition.braking,
                           end->condition.no_traction,
                           end->condition.crawling,
                           end->has_position,
                           cell->has_altitude,
                           cell->live_consistent,
                           cell->lagged_consistent};
    uint32_t word = 0U;
    for (unsigned int i = 0U; i < 8U; i++) {
        word |= (flags[i] ? 1U : 0U) << i;
    }
    uint8_t record[CELL_BYTES];
    uint8_t *next = put_word(record, (uint32_t)end->time_us);
    next = put_word(next, (uint32_t)(end->time_us >> 32));
    next = put_word(next, end->cell);
    next = put_word(next, word);
    next = put_word(next, (uint32_t)end->latitude_e7);
    next = put_word(next, (uint32_t)end->longitude_e7);
    next = put_float(next, end->speed_mps);
    next = put_uncertain(next, cell->live_grade_percent);
    next = put_uncertain(next, cell->lagged_grade_percent);
    (void)put_uncertain(next, cell->altitude_m);
    return fwrite(record, sizeof record, 1U, file) == 1U;
}

/* Passes a frame on. Remote frames carry nothing: they are left out. */
static GradeStatus take_frame(const uint8_t *record) {
    const uint32_t extended = UINT32_C(1) << 31;
    const uint32_t remote = UINT32_C(1) << 30;
    const uint64_t time_us = word_at(record) | ((uint64_t)word_at(record + 4) << 32);
    const uint32_t flagged = word_at(record + 8);
    if ((flagged & remote) != 0U) {
        return GRADE_STATUS_OK;
    }
    const uint8_t is_extended = (uint8_t)(((flagged & extended) != 0U) ? 1U : 0U);
    return grade_on_frame(estimator, time_us, flagged & ~(extended | remote), is_extended,
                          record + 16, word_at(record + 12));
}

static GradeStatus drive(FILE *frames, FILE *cells) {
    uint8_t record[FRAME_BYTES];
    GradeFinishedCell cell;
    GradeStatus status;
    while (fread(record, sizeof record, 1U, frames) == 1U) {
        status = take_frame(record);
        if (status != GRADE_STATUS_OK) {
            return status;
        }
        while (grade_step(estimator) == GRADE_STATUS_OK) {
            while (grade_next_cell(estimator, &cell) == GRADE_STATUS_OK) {
                if (!write_cell(cells, &cell)) {
                    return GRADE_STATUS_TOO_SMALL;
                }
            }
        }
    }
    do {
        status = grade_drain_cell(estimator, &cell);
    } while ((status == GRADE_STATUS_OK) && write_cell(cells, &cell));
    return (status == GRADE_STATUS_NOTHING) ? GRADE_STATUS_OK : status;
}

int main(void) {
    FILE *frames = fopen("drive.bin", "rb");
    FILE *cells = fopen("cells.bin", "wb");
    if ((frames == NULL) || (cells == NULL)) {
        (void)fprintf(stderr, "drive.bin or cells.bin cannot be opened\n");
        return 1;
    }
    const size_t length = fread(vehicle, 1U, sizeof vehicle, frames);
    GradeStatus status =
        grade_create_packed(&memory, sizeof memory, vehicle, length, &estimator);
    if (status == GRADE_STATUS_OK) {
        status = drive(frames, cells);
    }
    if (fclose(cells) != 0) {
        status = GRADE_STATUS_TOO_SMALL;
    }
    (void)fclose(frames);
    if (status != GRADE_STATUS_OK) {
        (void)fprintf(stderr, "status %d\n", (int)status);
        return 1;
    }
    (void)printf("version %s\n", grade_version());
    return 0;
}
