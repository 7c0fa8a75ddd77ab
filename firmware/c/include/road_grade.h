/* Road-grade estimator: interface for C99 and C++.
 *
 * All memory is the caller's: no function allocates, blocks, calls back or reads a clock. Every
 * function returns a GradeStatus; what it produces goes to the caller's objects, which stay as they
 * are unless it returns GRADE_STATUS_OK. A pointer that is null or misaligned is an error of its own.
 * A call that interrupts another one on the same estimator or map returns GRADE_STATUS_BUSY.
 * See docs/c.md. */

#ifndef ROAD_GRADE_H
#define ROAD_GRADE_H

/* Made from the sources by `cargo run -p cross-tests --example c_header -- --write`. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/**
 * Length of a cell, m; the step of the thesis.
 */
#define GRADE_CELL_LENGTH_M 2.5

/**
 * Memory for an estimator, bytes. It is enough on every target; `grade_estimator_bytes` tells the
 * exact number.
 */
#define GRADE_ESTIMATOR_BYTES 98304

/**
 * Alignment of that memory, bytes.
 */
#define GRADE_ALIGNMENT 8

/**
 * Length of a packed vehicle, bytes.
 */
#define GRADE_PACKED_VEHICLE_BYTES 1008

/**
 * Length of a persistent state, bytes.
 */
#define GRADE_PERSISTENT_STATE_BYTES 108

/**
 * Memory for a map's place and horizon, bytes. It is enough on every target; `grade_map_bytes` tells
 * the exact number. The map itself stays where it is.
 */
#define GRADE_MAP_BYTES 8192

/**
 * Most forward gears of a vehicle.
 */
#define GRADE_MOST_GEARS 24

/**
 * Most effects of a vehicle.
 */
#define GRADE_MOST_EFFECTS 16

/**
 * Value of `gear_count` for a measured traction force: the powertrain is left out.
 */
#define GRADE_MEASURED_FORCE UINT32_MAX

/**
 * What became of a call. All but `OK` leave the caller's objects as they are.
 */
typedef enum GradeStatus {
    /**
     * It is done.
     */
    GRADE_STATUS_OK = 0,
    /**
     * There is nothing to return yet.
     */
    GRADE_STATUS_NOTHING = 1,
    /**
     * A pointer is null.
     */
    GRADE_STATUS_NULL = 2,
    /**
     * A pointer is not aligned as its type demands.
     */
    GRADE_STATUS_MISALIGNED = 3,
    /**
     * Memory or buffer are too small.
     */
    GRADE_STATUS_TOO_SMALL = 4,
    /**
     * No estimator or map was created here, or it was released, moved or overwritten.
     */
    GRADE_STATUS_NOT_CREATED = 5,
    /**
     * There is an estimator or map here already. Release it first.
     */
    GRADE_STATUS_ALREADY_CREATED = 6,
    /**
     * The call interrupts another one on the same object.
     */
    GRADE_STATUS_BUSY = 7,
    /**
     * A parameter of the vehicle is impossible.
     */
    GRADE_STATUS_VEHICLE = 8,
    /**
     * The bytes are not a packed vehicle of this version.
     */
    GRADE_STATUS_PACKED_VEHICLE = 9,
    /**
     * The bytes are not a persistent state of this version.
     */
    GRADE_STATUS_PERSISTENT_STATE = 10,
    /**
     * The persistent state is that of another vehicle, or of other parameters.
     */
    GRADE_STATUS_OTHER_VEHICLE = 11,
    /**
     * No CAN frame has this identifier or length.
     */
    GRADE_STATUS_FRAME = 12,
    /**
     * There is no signal of this number.
     */
    GRADE_STATUS_SIGNAL = 13,
    /**
     * The bytes are not a packed map of this version, or are damaged here.
     */
    GRADE_STATUS_MAP = 14,
    /**
     * A distance or step is not a positive, finite number.
     */
    GRADE_STATUS_DISTANCE = 15,
} GradeStatus;

/**
 * A grade estimator for one vehicle, in the caller's memory.
 */
typedef struct GradeEstimator GradeEstimator;

/**
 * A map that a vehicle follows, in the caller's memory.
 */
typedef struct GradeMap GradeMap;

/**
 * One gear.
 */
typedef struct GradeVehicleGear {
    /**
     * Engine turns to one turn of the output shaft.
     */
    float ratio;
    /**
     * Part of the power that comes through, 0.5 to 1.
     */
    float efficiency;
} GradeVehicleGear;

/**
 * One adopted effect, as a diagnosis wrote it to the vehicle file.
 */
typedef struct GradeVehicleEffect {
    /**
     * Its number, which never changes (docs/formats.md).
     */
    uint32_t number;
    /**
     * Its amount, in its unit.
     */
    float amount;
    /**
     * One standard deviation of the amount.
     */
    float amount_sigma;
    /**
     * Its parameters; not a number where it has none.
     */
    float parameters[3];
} GradeVehicleEffect;

/**
 * A vehicle: what docs/formats.md says of a vehicle file.
 */
typedef struct GradeVehicle {
    /**
     * Mass of the whole combination, kg.
     */
    float mass_kg;
    /**
     * Drag coefficient times frontal area, m².
     */
    float drag_area_m2;
    /**
     * Rolling resistance coefficient, 1.
     */
    float rolling_resistance;
    /**
     * Effective radius of the driven wheels, m.
     */
    float wheel_radius_m;
    /**
     * Moment of inertia of all wheels, kg m².
     */
    float wheel_inertia_kgm2;
    /**
     * Moment of inertia of the engine, kg m².
     */
    float engine_inertia_kgm2;
    /**
     * Torque that 100 % stands for (SPN 544), Nm.
     */
    float reference_torque_nm;
    /**
     * Output shaft turns to one turn of the wheels.
     */
    float final_drive_ratio;
    /**
     * Part of the power that comes through the final drive, 0.5 to 1.
     */
    float final_drive_efficiency;
    /**
     * Number of gears, or `GRADE_MEASURED_FORCE`.
     */
    uint32_t gear_count;
    /**
     * The gears, first gear first.
     */
    struct GradeVehicleGear gears[GRADE_MOST_GEARS];
    /**
     * Number of effects.
     */
    uint32_t effect_count;
    /**
     * The effects.
     */
    struct GradeVehicleEffect effects[GRADE_MOST_EFFECTS];
} GradeVehicle;

/**
 * Why the vehicle model does not hold in a cell; all false where it holds.
 */
typedef struct GradeCondition {
    /**
     * A gear shift or its hold time is on.
     */
    bool shifting;
    /**
     * A brake other than the engine, or its hold time, is on.
     */
    bool braking;
    /**
     * The traction force is unknown: torque is stale or not available, or the gear is unknown.
     */
    bool no_traction;
    /**
     * The speed is too low for the wheel sensors. The model still holds.
     */
    bool crawling;
} GradeCondition;

/**
 * Where and when a cell of 2.5 m ends.
 */
typedef struct GradeEnd {
    /**
     * Time at which the vehicle reaches it, µs, by the clock of the frames.
     */
    uint64_t time_us;
    /**
     * Driven distance divided by 2.5 m.
     */
    uint32_t cell;
    /**
     * Whether the position is known.
     */
    bool has_position;
    /**
     * Latitude, 1e-7 degrees.
     */
    int32_t latitude_e7;
    /**
     * Longitude, 1e-7 degrees.
     */
    int32_t longitude_e7;
    /**
     * Measured speed, m/s.
     */
    float speed_mps;
    /**
     * Why the vehicle model does not hold; all false where it holds.
     */
    struct GradeCondition condition;
} GradeEnd;

/**
 * An estimate with its standard deviation.
 */
typedef struct GradeUncertain {
    /**
     * The estimate.
     */
    float value;
    /**
     * Its standard deviation.
     */
    float sigma;
} GradeUncertain;

/**
 * What disagrees in a cell: signals that cannot all be right. All false where everything agrees.
 */
typedef struct GradeDisagreement {
    /**
     * Climb by GNSS and climb by the forces.
     */
    bool climb;
    /**
     * Descent by GNSS and a vehicle that gains no speed: a brake that no signal reports.
     */
    bool brake;
    /**
     * Torque and acceleration or climb, or torque that another sender than the engine gives.
     */
    bool torque;
    /**
     * Wheel speed and engine speed, or wheel speeds of two senders.
     */
    bool speed;
    /**
     * Reported gear, engine speed and wheel speed.
     */
    bool gear;
} GradeDisagreement;
/**
 * Everything agrees.
 */
#define GradeDisagreement_NONE (GradeDisagreement){ .climb = false, .brake = false, .torque = false, .speed = false, .gear = false }
/**
 * Number of kinds of disagreement.
 */
#define GradeDisagreement_KINDS 5

/**
 * What is known at the end of the newest cell.
 */
typedef struct GradeLiveEstimate {
    /**
     * The end of the newest cell.
     */
    struct GradeEnd end;
    /**
     * Grade: 100 tan of the slope angle, positive uphill in the direction of travel, %.
     */
    struct GradeUncertain grade_percent;
    /**
     * Whether the altitude is known.
     */
    bool has_altitude;
    /**
     * Altitude in the datum of the GNSS source, m.
     */
    struct GradeUncertain altitude_m;
    /**
     * Bias of the vehicle model: the grade that it reads too high, %.
     */
    struct GradeUncertain bias_percent;
    /**
     * Scale factor of the vehicle model, 1.
     */
    struct GradeUncertain scale;
    /**
     * Gross mass of the combination, kg.
     */
    struct GradeUncertain mass_kg;
    /**
     * What disagrees here. Where anything does, the sigma may be too small.
     */
    struct GradeDisagreement disagreement;
} GradeLiveEstimate;

/**
 * A finished cell, 500 m back.
 */
typedef struct GradeFinishedCell {
    /**
     * Where and when it ends.
     */
    struct GradeEnd end;
    /**
     * Live grade: from the measurements up to its end, %.
     */
    struct GradeUncertain live_grade_percent;
    /**
     * Lagged grade: from the measurements up to a fixed lag later, %.
     */
    struct GradeUncertain lagged_grade_percent;
    /**
     * Whether the altitude is known.
     */
    bool has_altitude;
    /**
     * Altitude in the datum of the GNSS source, m.
     */
    struct GradeUncertain altitude_m;
    /**
     * Whether nothing disagreed, as far as was known at its end.
     */
    bool live_consistent;
    /**
     * Whether nothing disagrees, as far as is known a fixed lag later.
     */
    bool lagged_consistent;
} GradeFinishedCell;

/**
 * Counts since the start. They saturate, except those of frames, readings, steps and altitudes,
 * whose largest value no drive reaches: steps last for ten million kilometres.
 */
typedef struct GradeCounters {
    /**
     * Frames given to the estimator.
     */
    uint64_t frames;
    /**
     * Frames that carried readings.
     */
    uint64_t frames_decoded;
    /**
     * Frames of messages that the decoder does not read.
     */
    uint64_t frames_ignored;
    /**
     * Frames of known messages that are too short, or remote, or announce an impossible session.
     */
    uint32_t frames_malformed;
    /**
     * Fast packets dropped because of missing, repeated or swapped frames.
     */
    uint32_t fast_packets_broken;
    /**
     * Transport sessions dropped because of missing, swapped or late packets.
     */
    uint32_t sessions_broken;
    /**
     * Inputs older than the one before.
     */
    uint32_t time_backwards;
    /**
     * Single inputs far ahead of the one before.
     */
    uint32_t times_ahead;
    /**
     * Times that the receiver's clock was set back, or restarted.
     */
    uint32_t clocks_set_back;
    /**
     * Long silences, or jumps of the receiver's clock: they look the same.
     */
    uint32_t silences;
    /**
     * Readings with the code "not available".
     */
    uint32_t not_available;
    /**
     * Readings with the code "error", and non-finite readings.
     */
    uint32_t errors;
    /**
     * Parameters of the vehicle that the bus contradicted: its values are used.
     */
    uint32_t parameters_replaced;
    /**
     * Readings from another source than the one in use.
     */
    uint32_t other_source;
    /**
     * Times that another source took over a signal from a silent one.
     */
    uint32_t source_switches;
    /**
     * Times that a message came far faster than before: two may send it from one address.
     */
    uint32_t rates_exceeded;
    /**
     * Speeds that no vehicle can have reached from the one before, or that two senders seem to send.
     */
    uint32_t speed_leaps;
    /**
     * Speeds that stayed the same to the last digit while the engine speed changed.
     */
    uint32_t frozen_speeds;
    /**
     * Speeds that moved the odometer.
     */
    uint64_t speeds_used;
    /**
     * Readings that gave a traction force: torque with a gear, or a force.
     */
    uint64_t tractions_used;
    /**
     * GNSS fixes without a usable altitude.
     */
    uint32_t poor_fixes;
    /**
     * GNSS fixes that repeated an altitude over a distance on which no receiver does.
     */
    uint32_t frozen_fixes;
    /**
     * Times that the vehicle began to reverse.
     */
    uint32_t reversals;
    /**
     * Gaps without speed.
     */
    uint32_t gaps;
    /**
     * Samples lost because `step` was not called often enough.
     */
    uint32_t samples_lost;
    /**
     * Finished cells overwritten because they were not fetched.
     */
    uint32_t cells_lost;
    /**
     * Finished cells with a non-finite lagged grade.
     */
    uint32_t cells_unsound;
    /**
     * Finished cells in which signals disagree: the lagged sigma may be too small.
     */
    uint32_t cells_suspect;
    /**
     * Filter steps.
     */
    uint32_t steps;
    /**
     * Steps with an invalid model (shift, brake, no traction).
     */
    uint32_t invalid_steps;
    /**
     * Altitudes used.
     */
    uint32_t altitudes_used;
    /**
     * Altitudes that the live filter left out: it gates them, the lagged estimate weighs them.
     */
    uint32_t altitudes_rejected;
    /**
     * Slopes that were measured directly, and used live.
     */
    uint32_t slopes_used;
    /**
     * Such slopes that the live filter left out.
     */
    uint32_t slopes_rejected;
    /**
     * Speeds that differ from the prediction by more than the model allows; the speed was reset.
     */
    uint32_t speed_steps;
    /**
     * Stops after which the load may be another one.
     */
    uint32_t loads_reopened;
    /**
     * Steps with a result that is no number; the filter was restarted.
     */
    uint32_t restarts;
} GradeCounters;

/**
 * The live grade with the map.
 */
typedef struct GradeMapEstimate {
    /**
     * Whether the map has a grade here.
     */
    bool has_map_grade;
    /**
     * Grade of the map, with the error of the place, %.
     */
    struct GradeUncertain map_grade_percent;
    /**
     * Whether estimate and map are combined: not where the map is left out.
     */
    bool has_combined_grade;
    /**
     * Live grade and grade of the map together, %.
     */
    struct GradeUncertain combined_grade_percent;
    /**
     * Whether the map is left out because it differs from the estimate.
     */
    bool is_left_out;
} GradeMapEstimate;

/**
 * A place ahead.
 */
typedef struct GradePlaceAhead {
    /**
     * Number of its branch; 0 is the most probable path.
     */
    uint32_t branch;
    /**
     * Probability of the branch, seen from the vehicle.
     */
    float probability;
    /**
     * Distance from the vehicle, m.
     */
    float ahead_m;
    /**
     * Whether the map has a grade there.
     */
    bool has_grade;
    /**
     * Grade there, %.
     */
    struct GradeUncertain grade_percent;
} GradePlaceAhead;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Returns the version of this library, as "major.minor.patch".
 */
const char *grade_version(void);

/**
 * Returns the memory that an estimator takes on this target, bytes.
 */
size_t grade_estimator_bytes(void);

/**
 * Creates an estimator for a vehicle in `bytes` bytes of `memory`, aligned to
 * `GRADE_ALIGNMENT`. Zero the memory before the first time. Its place must not change.
 *
 * Errors: `NULL`, `MISALIGNED`, `TOO_SMALL`, `ALREADY_CREATED`, `BUSY`, `VEHICLE`.
 *
 * # Safety
 * `memory` has `bytes` bytes, which only this library uses until the release; `vehicle` and `out`
 * lead to objects of their types.
 */
enum GradeStatus grade_create(void *memory,
                              size_t bytes,
                              const struct GradeVehicle *vehicle,
                              struct GradeEstimator **out);

/**
 * Creates an estimator for a packed vehicle (docs/formats.md), as `grade_create` does.
 *
 * Errors: those of `grade_create`, and `PACKED_VEHICLE`.
 *
 * # Safety
 * As for `grade_create`; `vehicle` leads to `length` bytes.
 */
enum GradeStatus grade_create_packed(void *memory,
                                     size_t bytes,
                                     const uint8_t *vehicle,
                                     size_t length,
                                     struct GradeEstimator **out);

/**
 * Creates an estimator for a vehicle that begins with what an earlier drive left.
 *
 * Errors: those of `grade_create`, `PERSISTENT_STATE` and `OTHER_VEHICLE`. After either of these,
 * begin without it.
 *
 * # Safety
 * As for `grade_create`; `state` leads to `state_length` bytes.
 */
enum GradeStatus grade_restore(void *memory,
                               size_t bytes,
                               const struct GradeVehicle *vehicle,
                               const uint8_t *state,
                               size_t state_length,
                               struct GradeEstimator **out);

/**
 * Creates an estimator for a packed vehicle that begins with what an earlier drive left.
 *
 * Errors: those of `grade_create_packed` and `grade_restore`.
 *
 * # Safety
 * As for `grade_create_packed` and `grade_restore`.
 */
enum GradeStatus grade_restore_packed(void *memory,
                                      size_t bytes,
                                      const uint8_t *vehicle,
                                      size_t length,
                                      const uint8_t *state,
                                      size_t state_length,
                                      struct GradeEstimator **out);

/**
 * Releases an estimator. Its memory is the caller's again.
 *
 * Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`.
 *
 * # Safety
 * `estimator` leads to memory of an estimator.
 */
enum GradeStatus grade_release(struct GradeEstimator *estimator);

/**
 * Takes one classic CAN data frame, received at `time_us` by any clock that only goes forward.
 * Leave out error and remote frames. What is unusable is counted (`grade_counters`).
 *
 * Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`, `FRAME`.
 *
 * # Safety
 * `estimator` leads to memory of an estimator, `data` to `length` bytes.
 */
enum GradeStatus grade_on_frame(struct GradeEstimator *estimator,
                                uint64_t time_us,
                                uint32_t identifier,
                                uint8_t is_extended,
                                const uint8_t *data,
                                size_t length);

/**
 * Returns the number of the signal of this name, for `grade_on_reading`: a column of a signal table
 * (docs/formats.md), as "wheel_speed_mps".
 *
 * Errors: `NULL`, `MISALIGNED`, `SIGNAL`.
 *
 * # Safety
 * `name` leads to `length` bytes, `out` to a number.
 */
enum GradeStatus grade_signal(const char *name, size_t length, uint32_t *out);

/**
 * Takes one reading of a signal (`grade_signal`) that does not come from the bus, in the unit of its
 * name. A value that is not finite is "not available".
 *
 * Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`, `SIGNAL`.
 *
 * # Safety
 * `estimator` leads to memory of an estimator.
 */
enum GradeStatus grade_on_reading(struct GradeEstimator *estimator,
                                  uint64_t time_us,
                                  uint32_t signal,
                                  double value);

/**
 * Does a share of work: moves the filter over one cell of 2.5 m, or goes on with the lagged
 * estimates. Call it after each frame until it returns `NOTHING`.
 *
 * Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`; `NOTHING` if nothing is left to do.
 *
 * # Safety
 * `estimator` leads to memory of an estimator.
 */
enum GradeStatus grade_step(struct GradeEstimator *estimator);

/**
 * Returns the estimate at the end of the newest cell.
 *
 * Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`; `NOTHING` before the first cell.
 *
 * # Safety
 * `estimator` leads to memory of an estimator, `out` to an object of its type.
 */
enum GradeStatus grade_live(struct GradeEstimator *estimator, struct GradeLiveEstimate *out);

/**
 * Returns the next finished cell, whose lag is over. Call it after each step until it returns
 * `NOTHING`.
 *
 * Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`; `NOTHING` if none is finished.
 *
 * # Safety
 * `estimator` leads to memory of an estimator, `out` to an object of its type.
 */
enum GradeStatus grade_next_cell(struct GradeEstimator *estimator, struct GradeFinishedCell *out);

/**
 * Returns the next of the last cells of a drive, which are smoothed by less than the full lag. What
 * comes afterwards begins a new chain of cells.
 *
 * Errors: as for `grade_next_cell`.
 *
 * # Safety
 * As for `grade_next_cell`.
 */
enum GradeStatus grade_drain_cell(struct GradeEstimator *estimator, struct GradeFinishedCell *out);

/**
 * Writes what this drive leaves for the next one to `capacity` bytes; it takes
 * `GRADE_PERSISTENT_STATE_BYTES`.
 *
 * Errors: `NULL`, `MISALIGNED`, `TOO_SMALL`, `NOT_CREATED`, `BUSY`; `NOTHING` before 5 km with GNSS.
 *
 * # Safety
 * `estimator` leads to memory of an estimator, `out` to `capacity` bytes.
 */
enum GradeStatus grade_persistent_state(struct GradeEstimator *estimator,
                                        uint8_t *out,
                                        size_t capacity);

/**
 * Returns the counts of what happened so far, by kind.
 *
 * Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`.
 *
 * # Safety
 * `estimator` leads to memory of an estimator, `out` to an object of its type.
 */
enum GradeStatus grade_counters(struct GradeEstimator *estimator, struct GradeCounters *out);

/**
 * Returns the memory that a map takes on this target, bytes.
 */
size_t grade_map_bytes(void);

/**
 * Opens a packed map of `length` bytes (docs/map-grade.md) in `bytes` bytes of `memory`, aligned to
 * `GRADE_ALIGNMENT`. The packed map is read in place, from flash for example.
 *
 * Errors: `NULL`, `MISALIGNED`, `TOO_SMALL`, `ALREADY_CREATED`, `BUSY`, `MAP`.
 *
 * # Safety
 * `memory` has `bytes` bytes, which only this library uses until the release. `packed` leads to
 * `length` bytes that do not change until then.
 */
enum GradeStatus grade_map_create(void *memory,
                                  size_t bytes,
                                  const uint8_t *packed,
                                  size_t length,
                                  struct GradeMap **out);

/**
 * Releases a map. Its memory is the caller's again.
 *
 * Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`.
 *
 * # Safety
 * `map` leads to memory of a map.
 */
enum GradeStatus grade_map_release(struct GradeMap *map);

/**
 * Moves the estimator over one cell, and the map with it: instead of `grade_step`.
 *
 * Errors: those of `grade_step`, of either object.
 *
 * # Safety
 * `map` and `estimator` lead to memory of theirs.
 */
enum GradeStatus grade_map_step(struct GradeMap *map, struct GradeEstimator *estimator);

/**
 * Returns the next finished cell, and compares the map with it: instead of `grade_next_cell`.
 *
 * Errors: those of `grade_next_cell`, of either object.
 *
 * # Safety
 * `map` and `estimator` lead to memory of theirs, `out` to an object of its type.
 */
enum GradeStatus grade_map_next_cell(struct GradeMap *map,
                                     struct GradeEstimator *estimator,
                                     struct GradeFinishedCell *out);

/**
 * Returns the live grade with the map.
 *
 * Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`.
 *
 * # Safety
 * `map` leads to memory of a map, `out` to an object of its type.
 */
enum GradeStatus grade_map_live(struct GradeMap *map, struct GradeMapEstimate *out);

/**
 * Writes the grade ahead to at most `capacity` places: each branch every `step_m` metres up to
 * `length_m`, the most probable path first. `count` is the number of places written. Where the
 * capacity does not suffice, the farther places and the less probable branches are left out.
 *
 * Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`, `DISTANCE`, `MAP`; `NOTHING` where the place on
 * the map is not known.
 *
 * # Safety
 * `map` leads to memory of a map, `out` to memory for `capacity` places, `count` to a number.
 */
enum GradeStatus grade_map_horizon(struct GradeMap *map,
                                   float length_m,
                                   float step_m,
                                   struct GradePlaceAhead *out,
                                   size_t capacity,
                                   size_t *count);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ROAD_GRADE_H */
