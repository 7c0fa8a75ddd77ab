/* Mistakes of a C program, and the status that each returns. Ends with 0 if all are as documented. */

#include "road_grade.h"

#include <stdio.h>
#include <string.h>

static union {
    uint64_t alignment;
    uint8_t bytes[GRADE_ESTIMATOR_BYTES + GRADE_ALIGNMENT];
} first, second;

static union {
    uint64_t alignment;
    uint8_t bytes[GRADE_MAP_BYTES];
} map_memory;

static int failures = 0;

static void expect(const char *what, GradeStatus expected, GradeStatus found) {
    if (found != expected) {
        failures++;
        (void)fprintf(stderr, "%s: status %d; expected %d\n", what, (int)found, (int)expected);
    }
}

static GradeVehicle truck(void) {
    GradeVehicle vehicle;
    (void)memset(&vehicle, 0, sizeof vehicle);
    vehicle.mass_kg = 19000.0F;
    vehicle.drag_area_m2 = 5.2F;
    vehicle.rolling_resistance = 0.008F;
    vehicle.wheel_radius_m = 0.48F;
    vehicle.wheel_inertia_kgm2 = 60.0F;
    vehicle.gear_count = GRADE_MEASURED_FORCE;
    return vehicle;
}

static void creation(GradeEstimator **estimator) {
    GradeVehicle vehicle = truck();
    const size_t size = GRADE_ESTIMATOR_BYTES;
    GradeEstimator *other = NULL;
    expect("no memory", GRADE_STATUS_NULL, grade_create(NULL, size, &vehicle, estimator));
    expect("misaligned memory", GRADE_STATUS_MISALIGNED,
           grade_create(first.bytes + 1, size, &vehicle, estimator));
    expect("too little memory", GRADE_STATUS_TOO_SMALL,
           grade_create(first.bytes, grade_estimator_bytes() - 1U, &vehicle, estimator));
    expect("no vehicle", GRADE_STATUS_NULL, grade_create(first.bytes, size, NULL, estimator));
    expect("no place for the result", GRADE_STATUS_NULL,
           grade_create(first.bytes, size, &vehicle, NULL));
    vehicle.mass_kg = -1.0F;
    expect("impossible mass", GRADE_STATUS_VEHICLE,
           grade_create(first.bytes, size, &vehicle, estimator));
    vehicle = truck();
    vehicle.gear_count = GRADE_MOST_GEARS + 1U;
    expect("too many gears", GRADE_STATUS_VEHICLE,
           grade_create(first.bytes, size, &vehicle, estimator));
    vehicle.gear_count = 0U;
    expect("no gears", GRADE_STATUS_VEHICLE,
           grade_create(first.bytes, size, &vehicle, estimator));
    vehicle = truck();
    vehicle.effect_count = UINT32_MAX;
    expect("too many effects", GRADE_STATUS_VEHICLE,
           grade_create(first.bytes, size, &vehicle, estimator));
    vehicle.effect_count = 1U;
    vehicle.effects[0].number = 60000U;
    expect("unknown effect", GRADE_STATUS_VEHICLE,
           grade_create(first.bytes, size, &vehicle, estimator));
    expect("packed vehicle of another length", GRADE_STATUS_PACKED_VEHICLE,
           grade_create_packed(first.bytes, size, second.bytes, 7U, estimator));
    expect("packed vehicle of zeros", GRADE_STATUS_PACKED_VEHICLE,
           grade_create_packed(first.bytes, size, second.bytes, GRADE_PACKED_VEHICLE_BYTES,
                               estimator));
    expect("state of zeros", GRADE_STATUS_PERSISTENT_STATE,
           grade_restore_packed(first.bytes, size, second.bytes, GRADE_PACKED_VEHICLE_BYTES,
                                second.bytes, GRADE_PERSISTENT_STATE_BYTES, estimator));
    expect("use before creation", GRADE_STATUS_NOT_CREATED,
           grade_step((GradeEstimator *)(void *)first.bytes));
    vehicle = truck();
    expect("creation", GRADE_STATUS_OK, grade_create(first.bytes, size, &vehicle, estimator));
    expect("second creation", GRADE_STATUS_ALREADY_CREATED,
           grade_create(first.bytes, size, &vehicle, &other));
}

static void use(GradeEstimator *estimator) {
    const uint8_t data[8] = {0U};
    GradeLiveEstimate live;
    GradeFinishedCell cell;
    uint8_t state[GRADE_PERSISTENT_STATE_BYTES];
    uint32_t speed = 0U;
    expect("null estimator", GRADE_STATUS_NULL, grade_step(NULL));
    expect("misaligned estimator", GRADE_STATUS_MISALIGNED,
           grade_step((GradeEstimator *)(void *)(first.bytes + 1)));
    expect("no step", GRADE_STATUS_NOTHING, grade_step(estimator));
    expect("no live estimate", GRADE_STATUS_NOTHING, grade_live(estimator, &live));
    expect("no cell", GRADE_STATUS_NOTHING, grade_next_cell(estimator, &cell));
    expect("no place for a cell", GRADE_STATUS_NULL, grade_next_cell(estimator, NULL));
    expect("no state", GRADE_STATUS_NOTHING,
           grade_persistent_state(estimator, state, sizeof state));
    expect("no place for counters", GRADE_STATUS_NULL, grade_counters(estimator, NULL));
    expect("frame without data", GRADE_STATUS_NULL,
           grade_on_frame(estimator, 0U, 1U, 1U, NULL, 8U));
    expect("empty frame", GRADE_STATUS_OK, grade_on_frame(estimator, 0U, 1U, 1U, NULL, 0U));
    expect("long frame", GRADE_STATUS_FRAME, grade_on_frame(estimator, 0U, 1U, 1U, data, 9U));
    expect("identifier of 30 bits", GRADE_STATUS_FRAME,
           grade_on_frame(estimator, 0U, UINT32_C(1) << 29, 1U, data, 8U));
    expect("identifier of 12 bits", GRADE_STATUS_FRAME,
           grade_on_frame(estimator, 0U, 2048U, 0U, data, 8U));
    expect("name of a signal", GRADE_STATUS_OK, grade_signal("wheel_speed_mps", 15U, &speed));
    expect("wrong name", GRADE_STATUS_SIGNAL, grade_signal("wheel_speed_mph", 15U, &speed));
    expect("no name", GRADE_STATUS_NULL, grade_signal(NULL, 0U, &speed));
    expect("number of no signal", GRADE_STATUS_SIGNAL,
           grade_on_reading(estimator, 0U, 5000U, 1.0));
    expect("reading", GRADE_STATUS_OK, grade_on_reading(estimator, 1000U, speed, 10.0));
}

static void moved(const GradeEstimator *estimator) {
    (void)memcpy(second.bytes, estimator, GRADE_ESTIMATOR_BYTES);
    expect("copy elsewhere", GRADE_STATUS_NOT_CREATED,
           grade_step((GradeEstimator *)(void *)second.bytes));
}

static void maps(GradeEstimator *estimator) {
    GradeMap *map = NULL;
    GradeMapEstimate live;
    const uint8_t packed[64] = {0U};
    expect("map of zeros", GRADE_STATUS_MAP,
           grade_map_create(map_memory.bytes, sizeof map_memory, packed, sizeof packed, &map));
    expect("no map", GRADE_STATUS_NULL,
           grade_map_create(map_memory.bytes, sizeof map_memory, NULL, 0U, &map));
    expect("too little memory for a map", GRADE_STATUS_TOO_SMALL,
           grade_map_create(map_memory.bytes, 16U, packed, sizeof packed, &map));
    expect("map before creation", GRADE_STATUS_NOT_CREATED,
           grade_map_live((GradeMap *)(void *)map_memory.bytes, &live));
    expect("null map", GRADE_STATUS_NULL, grade_map_step(NULL, estimator));
}

static void release(GradeEstimator *estimator) {
    expect("release", GRADE_STATUS_OK, grade_release(estimator));
    expect("second release", GRADE_STATUS_NOT_CREATED, grade_release(estimator));
    expect("use after release", GRADE_STATUS_NOT_CREATED, grade_step(estimator));
}

int main(void) {
    GradeEstimator *estimator = NULL;
    creation(&estimator);
    use(estimator);
    moved(estimator);
    maps(estimator);
    release(estimator);
    (void)printf("%d mistakes are not as documented\n", failures);
    return (failures == 0) ? 0 : 1;
}
