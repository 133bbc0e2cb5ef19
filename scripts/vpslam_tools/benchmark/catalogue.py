"""The sequences that each suite runs, and what others reached on them.

Figures are the RMSE of the ATE in m of monocular systems after alignment by a similarity. The
paper's are those of its table I; "elsewhere" is the best or the range that was found published for
other systems, all of which ran in real time, some with loops closed.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Sequence:
    name: str                # as in tables
    folder: str              # below --data; or what the simulator is asked for
    paper: tuple = ()        # VP-SLAM, ORB-SLAM2, PL-SLAM
    elsewhere: str = ""
    note: str = ""


def _tum(camera, name, paper=(), elsewhere="", note=""):
    return Sequence(f"fr{camera}/{name}", f"rgbd_dataset_freiburg{camera}_{name}", paper, elsewhere,
                    note)


NO_TRUTH = "no truth is published: run, and compared with nothing"

TUM = [
    _tum(1, "desk", (0.032, 0.020, 0.032), ".015-.017"),
    _tum(1, "plant", (0.020, 0.020, 0.097), ".014-.016"),
    _tum(2, "desk", (0.012, 0.009, 0.012), ".0088"),
    _tum(3, "large_cabinet", (0.100, 1.420, 0.100), ".046"),
    _tum(3, "long_office_household_validation", (0.019, 0.010, 0.019), ".010", NO_TRUTH),
    _tum(3, "long_office_household", note="offered beside the one above, whose truth is not public"),
    _tum(3, "structure_texture_far", (0.010, 0.012, 0.008), ".0077"),
    _tum(3, "structure_texture_near", (0.014, 0.015, 0.014), ".0104"),
    _tum(3, "nostructure_texture_near_withloop", (0.177, 0.015, 0.177), ".0139"),
    _tum(3, "nostructure_texture_far", (0.029, 0.048, 0.029), ".022"),
]
SHARED = [Sequence(name, name) for name in (
    "red_kitchen", "kitti00_start", "car_park", "office_corridor", "large_cabinet", "tum_fr1_rpy",
    "tum_fr3_structure_notexture_far")]
EUROC = [Sequence(name, name) for name in (
    "MH_01_easy", "MH_02_easy", "MH_03_medium", "MH_04_difficult", "MH_05_difficult", "V1_01_easy",
    "V1_02_medium", "V1_03_difficult", "V2_01_easy", "V2_02_medium", "V2_03_difficult")]
ICL = ([Sequence(f"lr/kt{i}", f"living_room_traj{i}_frei_png") for i in range(4)]
       + [Sequence(f"of/kt{i}", f"traj{i}_frei_png") for i in range(4)])
KITTI = [Sequence(f"{i:02d}", f"sequences/{i:02d}") for i in range(11)]
SIM = [Sequence("room", "sim:room"), Sequence("corridor", "sim:corridor"),
       Sequence("room, lens distorted", "sim:room?distortion=1"),
       Sequence("room, another", "sim:room?seed=2")]

# The paper's table II: mean ms of VP-SLAM, ORB-SLAM2, PL-SLAM, by the columns of our tables.
PAPER_TIMES_MS = {
    "features": (96.94, 15.79, 96.64), "vps": (46.56, None, None),
    "initial_pose": (71.1, 49.06, 71.1), "local_map": (29.93, 26.61, 29.93),
    "total": (244.53, 91.46, 197.97),
    "insertion": (47.90, 45.82, 47.90), "feature_culling": (2.48, 1.89, 2.48),
    "feature_creation": (135.93, 21.93, 135.93), "keyframe_culling": (72.52, 70.07, 72.52),
    "local_ba": (1499.37, 1434.57, 1499.37), "mapping_total": (1758.2, 1574.28, 1711.64),
}
