"""Lets Valhalla route on the elevation tiles of a map, and compares its slopes with the map's.

Usage: compare.py ROADGRADE FOLDER

Makes a drive with the simulator, an OpenStreetMap extract of three ways along it, the map, and from
the map `edges.csv` and elevation tiles. Valhalla (pyvalhalla) builds its graph with the tiles. Each
of its edges must have the slopes of `edges.csv`, and a truck must find a route along all of them.
"""

import csv
import json
import os
import subprocess
import sys
from pathlib import Path

import osmium
from osmium.osm import mutable
import valhalla
from valhalla.config import get_config

# Valhalla samples altitudes in whole metres every 60 m, and stores slopes in whole percents.
TOLERANCE_PERCENT = 2.0
SCENARIO = '[road]\nlength_m = 8000.0\n[[runs]]\nname = "a"\ntruck = "A"\n'


def main(roadgrade: str, folder: Path) -> int:
    folder.mkdir(parents=True, exist_ok=True)
    run = drive(roadgrade, folder)
    write_extract(folder / "net.osm.pbf", run)
    command = [roadgrade, "fuse", "--road", "net.osm.pbf", "--out", "map.csv", "run.csv"]
    call(command, folder)
    road = ["--road", "net.osm.pbf"]
    call([roadgrade, "export", "map.csv", *road, "--format", "edges", "--out", "edges.csv"], folder)
    call([roadgrade, "export", "map.csv", "--format", "hgt", "--out", "elevation"], folder)
    actor = graph(folder)
    edges = [row for row in table(folder / "edges.csv") if row["direction"] == "forward"]
    problems = [problem for edge in edges for problem in compare(actor, edge)]
    print("\n".join(problems))
    first, last = edges[0], edges[-1]
    ends = [
        {"lat": float(first["from_latitude_deg"]), "lon": float(first["from_longitude_deg"])},
        {"lat": float(last["to_latitude_deg"]), "lon": float(last["to_longitude_deg"])},
    ]
    trip = actor.route({"locations": ends, "costing": "truck"})["trip"]
    length_km = sum(float(edge["length_m"]) for edge in edges) / 1000
    routed_km = trip["summary"]["length"]
    print(f"{len(edges)} edges compared; a truck's route has {routed_km:.2f} of {length_km:.2f} km")
    return 1 if problems or abs(routed_km - length_km) > 0.1 else 0


def call(command: list, folder: Path) -> None:
    subprocess.run([str(part) for part in command], cwd=folder, check=True, stdout=subprocess.DEVNULL)


def drive(roadgrade: str, folder: Path) -> list:
    (folder / "scenario.toml").write_text(SCENARIO)
    call([roadgrade, "simulate", "--scenario", "scenario.toml", "--out", "."], folder)
    vehicle = ["--vehicle", "a.vehicle.toml"]
    call([roadgrade, "estimate", *vehicle, "--out", "run.csv", "a.log"], folder)
    return [row for row in table(folder / "run.csv") if row["latitude_deg"]]


def table(path: Path) -> list:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def write_extract(path: Path, run: list) -> None:
    """Writes three ways along the run, with a node every 50 m."""
    points = run[::20]
    writer = osmium.SimpleWriter(str(path), overwrite=True)
    for number, row in enumerate(points, 1):
        place = (float(row["longitude_deg"]), float(row["latitude_deg"]))
        writer.add_node(mutable.Node(id=number, version=1, location=place))
    third = len(points) // 3
    for way, (start, end) in enumerate(
        [(1, third), (third, 2 * third), (2 * third, len(points))], 1
    ):
        tags = {"highway": "primary", "name": f"way {way}"}
        nodes = list(range(start, end + 1))
        writer.add_way(mutable.Way(id=way, version=1, nodes=nodes, tags=tags))
    writer.close()


def graph(folder: Path) -> "valhalla.Actor":
    (folder / "tiles").mkdir(exist_ok=True)
    config = get_config(tile_extract="", tile_dir=str(folder / "tiles"))
    config["additional_data"]["elevation"] = str(folder / "elevation")
    config["mjolnir"]["concurrency"] = 1
    path = folder / "valhalla.json"
    path.write_text(json.dumps(config))
    programs = str(Path(sys.prefix) / "bin")
    environment = {**os.environ, "PATH": os.pathsep.join([programs, os.environ["PATH"]])}
    command = ["valhalla_build_tiles", "-c", str(path), str(folder / "net.osm.pbf")]
    built = subprocess.run(command, capture_output=True, text=True, env=environment)
    if built.returncode:
        sys.exit(f"valhalla_build_tiles failed:\n{built.stdout[-2000:]}{built.stderr[-2000:]}")
    return valhalla.Actor(config)


def compare(actor: "valhalla.Actor", ours: dict) -> list:
    """Returns how Valhalla's edge in the middle of ours differs from it."""
    ends = [
        [float(ours[f"{end}_{angle}_deg"]) for end in ("from", "to")]
        for angle in ("latitude", "longitude")
    ]
    places = [{"lat": ends[0][i], "lon": ends[1][i]} for i in (0, 1)]
    request = {"shape": places, "costing": "auto", "shape_match": "map_snap"}
    keys = ["edge.weighted_grade", "edge.max_upward_grade", "edge.max_downward_grade", "edge.length", "edge.way_id"]
    request["filters"] = {"attributes": keys, "action": "include"}
    shape = actor.route({"locations": places, "costing": "auto"})["trip"]["legs"][0]["shape"]
    del request["shape"]
    request["encoded_polyline"] = shape
    request["shape_match"] = "edge_walk"
    found = [edge for edge in actor.trace_attributes(request)["edges"] if edge["length"] > 0.05]
    name = f"{ours['way']} {ours['direction']}"
    if [f"way/{edge['way_id']}" for edge in found] != [ours["way"]]:
        return [f"{name}: Valhalla has {found}"]
    theirs = found[0]
    print(name, ours["average_grade_percent"], ours["largest_up_percent"], ours["largest_down_percent"], theirs)
    pairs = [("max_upward_grade", "largest_up_percent"), ("max_downward_grade", "largest_down_percent")]
    return [
        f"{name}: {key} {theirs[key]}, {column} {ours[column]}"
        for key, column in pairs
        if abs(theirs[key] - float(ours[column])) > TOLERANCE_PERCENT
    ]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], Path(sys.argv[2]).resolve()))
