-- The map of `roadgrade fuse` as one statement, for engines that read Parquet.
--
-- It reads the view `placed`: runs on their roads, as `roadgrade place` and `fuse --placed` write them
-- (road, session, way, direction, cell, grade_percent, grade_variance_percent2, altitude_m,
-- altitude_variance_m2). A road is a single one, whose way and direction are null, or a network.
-- That a run is matched to its road is not for SQL; all that comes behind it is here. The view:
--
--   DuckDB:  CREATE VIEW placed AS SELECT * FROM
--                read_parquet('DIR/*/*.parquet', hive_partitioning = true);
--   Spark:   CREATE TEMPORARY VIEW placed USING parquet OPTIONS (path 'DIR');
--
-- Two levels, as in host-sim/src/map: the runs of a session become one estimate, the sessions the
-- map. On both, what estimates have in common is learned from how far they disagree; the formulas
-- and where they come from are in host-sim/src/map/fusion/dependence.rs. Numbers are written with an
-- exponent because Spark takes others for decimals.
WITH
-- One estimate of one cell: weights are 1/variance (limits: cell_sums.rs).
estimates AS (
    SELECT
        road, session, way, direction, cell, grade_percent,
        1e0 / LEAST(GREATEST(grade_variance_percent2, 1e-10), 1e6) AS weight,
        COALESCE(1e0 / altitude_variance_m2, 0e0) AS altitude_weight,
        COALESCE(altitude_m / altitude_variance_m2, 0e0) AS altitude_sum
    FROM placed
),
-- Runs of each session that has a name, cell by cell.
session_cells AS (
    SELECT
        road, session, way, direction, cell,
        COUNT(*) AS runs,
        SUM(weight) AS weight,
        SUM(weight * weight) AS weight_square,
        SUM(weight * grade_percent) AS grade_sum,
        SUM(weight * grade_percent * grade_percent) AS grade_square_sum,
        SUM(altitude_weight) AS altitude_weight,
        SUM(altitude_sum) AS altitude_sum
    FROM estimates
    WHERE session IS NOT NULL
    GROUP BY road, session, way, direction, cell
),
-- How far they disagree; 10 degrees of freedom expect a fifth of the variance to be common, and
-- 1000 m of cells are one observation (2.5e-3).
session_seen AS (
    SELECT
        road, session,
        1e1 + 2.5e-3 * SUM(runs - 1) AS freedom,
        1e1 + 2.5e-3 * SUM(
            CASE WHEN runs > 1 THEN weight * weight / weight_square - 1e0 ELSE 0e0 END
        ) AS shared_freedom,
        8e0 + 2.5e-3 * SUM(
            CASE WHEN runs > 1
                THEN GREATEST(grade_square_sum - grade_sum * grade_sum / weight, 0e0)
                ELSE 0e0 END
        ) AS chi_squared
    FROM session_cells
    GROUP BY road, session
),
session_shares AS (
    SELECT
        road, session, freedom, shared_freedom, chi_squared,
        LEAST(GREATEST((freedom - chi_squared) / shared_freedom, 2e-1), 4e-1) AS share
    FROM session_seen
),
-- Each session as one estimate, and runs without a session as they are.
sessions AS (
    SELECT
        c.road, c.way, c.direction, c.cell, c.runs,
        c.grade_sum / c.weight AS grade_percent,
        1e0 / LEAST(GREATEST(
            GREATEST(s.chi_squared / (s.freedom - s.share * s.shared_freedom), 1e0)
            * (1e0 - s.share + s.share * c.weight * c.weight / c.weight_square) / c.weight,
            1e-10), 1e6) AS weight,
        c.altitude_weight, c.altitude_sum
    FROM session_cells AS c
    JOIN session_shares AS s ON s.road = c.road AND s.session = c.session
    UNION ALL
    SELECT
        road, way, direction, cell, 1 AS runs, grade_percent, weight, altitude_weight, altitude_sum
    FROM estimates
    WHERE session IS NULL
),
road_cells AS (
    SELECT
        road, way, direction, cell,
        SUM(runs) AS runs,
        COUNT(*) AS sessions,
        SUM(weight) AS weight,
        SUM(weight * weight) AS weight_square,
        SUM(weight * grade_percent) AS grade_sum,
        SUM(weight * grade_percent * grade_percent) AS grade_square_sum,
        SUM(altitude_weight) AS altitude_weight,
        SUM(altitude_sum) AS altitude_sum
    FROM sessions
    GROUP BY road, way, direction, cell
),
-- As within sessions; of different vehicles and days a tenth is expected to be common.
road_seen AS (
    SELECT
        road,
        1e1 + 2.5e-3 * SUM(sessions - 1) AS freedom,
        1e1 + 2.5e-3 * SUM(
            CASE WHEN sessions > 1 THEN weight * weight / weight_square - 1e0 ELSE 0e0 END
        ) AS shared_freedom,
        9e0 + 2.5e-3 * SUM(
            CASE WHEN sessions > 1
                THEN GREATEST(grade_square_sum - grade_sum * grade_sum / weight, 0e0)
                ELSE 0e0 END
        ) AS chi_squared
    FROM road_cells
    GROUP BY road
),
road_shares AS (
    SELECT
        road, freedom, shared_freedom, chi_squared,
        LEAST(GREATEST((freedom - chi_squared) / shared_freedom, 1e-1), 2.5e-1) AS share
    FROM road_seen
),
fused AS (
    SELECT
        c.road, c.way, c.direction, c.cell, c.runs, c.altitude_weight,
        CASE WHEN c.altitude_weight > 0e0 THEN c.altitude_sum / c.altitude_weight END AS altitude_m,
        c.grade_sum / c.weight AS grade_percent,
        GREATEST(s.chi_squared / (s.freedom - s.share * s.shared_freedom), 1e0)
        * (1e0 - s.share + s.share * c.weight * c.weight / c.weight_square) / c.weight AS variance
    FROM road_cells AS c
    JOIN road_shares AS s ON s.road = c.road
),
-- The cells around each (altitude_datum.rs, position_error.rs).
around AS (
    SELECT
        *,
        LAG(cell, 1) OVER (PARTITION BY road, way, direction ORDER BY cell) AS cell_1,
        LAG(altitude_m, 1) OVER (PARTITION BY road, way, direction ORDER BY cell) AS altitude_1,
        LAG(grade_percent, 1) OVER (PARTITION BY road, way, direction ORDER BY cell) AS grade_1,
        LAG(cell, 4) OVER (PARTITION BY road, way, direction ORDER BY cell) AS cell_before,
        LAG(grade_percent, 4) OVER (PARTITION BY road, way, direction ORDER BY cell) AS grade_before,
        LEAD(cell, 4) OVER (PARTITION BY road, way, direction ORDER BY cell) AS cell_after,
        LEAD(grade_percent, 4) OVER (PARTITION BY road, way, direction ORDER BY cell) AS grade_after
    FROM fused
),
-- Steps of the altitude beyond the climb by the grade, and the change of the grade, % per m.
changes AS (
    SELECT
        *,
        CASE
            WHEN cell - cell_1 = 1
                AND ABS(altitude_m - altitude_1 - 1.25e-2 * (grade_1 + grade_percent)) > 1e0
                THEN altitude_m - altitude_1 - 1.25e-2 * (grade_1 + grade_percent)
            ELSE 0e0
        END AS step_m,
        CASE
            WHEN cell - cell_before = 4 AND cell_after - cell = 4
                THEN (grade_after - grade_before) / 2e1
            WHEN cell - cell_before = 4 THEN (grade_percent - grade_before) / 1e1
            WHEN cell_after - cell = 4 THEN (grade_after - grade_percent) / 1e1
            ELSE 0e0
        END AS change_per_m
    FROM around
),
shifted AS (
    SELECT
        *,
        -SUM(step_m) OVER (
            PARTITION BY road, way, direction ORDER BY cell ROWS BETWEEN UNBOUNDED PRECEDING AND CURRENT ROW
        ) AS shift_m
    FROM changes
),
levelled AS (
    SELECT
        *,
        SUM(altitude_weight * shift_m) OVER (PARTITION BY road, way, direction)
        / NULLIF(SUM(altitude_weight) OVER (PARTITION BY road, way, direction), 0e0) AS mean_shift_m
    FROM shifted
)
SELECT
    road,
    way,
    direction,
    cell * 2.5e0 AS distance_m,
    altitude_m + shift_m - mean_shift_m AS altitude_m,
    grade_percent,
    SQRT(variance + (1.6e-1 + 2.25e0 / runs) * change_per_m * change_per_m) AS grade_sigma_percent,
    runs
FROM levelled
ORDER BY road, way, direction, distance_m
