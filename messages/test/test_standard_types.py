# SPDX-License-Identifier: BSD-3-Clause
"""Our definitions of standard types are those of ROS 2: their type hashes are the ones that ROS 2 Jazzy prints
(`ros2 topic info --verbose`, REP-2011, RIHS01), which cover names, types and order of all fields, nested ones included.
"""

import hashlib
import json
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = {"tf2_msgs": ROOT / "ros_standin" / "tf2_msgs"}
TYPE_IDS = {"int8": 2, "uint8": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8, "uint64": 9, "float32": 10,
            "float64": 11, "bool": 15, "byte": 16, "string": 17}
NESTED, ARRAY, SEQUENCE = 1, 48, 144

HASHES = {
    "builtin_interfaces/msg/Time": "b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197",
    "geometry_msgs/msg/Accel": "dc448243ded9b1fcbcca24aba0c22f013dae06c354ba2d849571c0a2a3f57ca0",
    "geometry_msgs/msg/Point": "6963084842a9b04494d6b2941d11444708d892da2f4b09843b9c43f42a7f6881",
    "geometry_msgs/msg/Pose": "d501954e9476cea2996984e812054b68026ae0bfae789d9a10b23daf35cc90fa",
    "geometry_msgs/msg/PoseStamped": "10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8",
    "geometry_msgs/msg/PoseWithCovariance": "9a7c0fd234b7f45c6098745ecccd773ca1085670e64107135397aee31c02e1bb",
    "geometry_msgs/msg/Quaternion": "8a765f66778c8ff7c8ab94afcc590a2ed5325a1d9a076ffff38fbce36f458684",
    "geometry_msgs/msg/Transform": "beb83fbe698636351461f6f35d1abb20010c43d55374d81bd041f1ba2581fddc",
    "geometry_msgs/msg/TransformStamped": "0a241f87d04668d94099cbb5ba11691d5ad32c2f29682e4eb5653424bd275206",
    "geometry_msgs/msg/Twist": "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a",
    "geometry_msgs/msg/TwistWithCovariance": "49f574f033f095d8b6cd1beaca5ca7925e296e84af1716d16c89d38b059c8c18",
    "geometry_msgs/msg/Vector3": "cc12fe83e4c02719f1ce8070bfd14aecd40f75a96696a67a2a1f37f7dbb0765d",
    "geometry_msgs/msg/Vector3Stamped": "d4829622288cbb443886e7ea94ea5671a3b1be6bab4ad04224432a65f7d7887a",
    "geometry_msgs/msg/Wrench": "018e8519d57c16adbe97c9fe1460ef21fec7e31bc541de3d653a35895677ce52",
    "geometry_msgs/msg/WrenchStamped": "8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77",
    "nav_msgs/msg/Odometry": "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0",
    "nav_msgs/msg/Path": "1957a5bb3cee5da65c4e52e52b65a93df227efce4c20f8458b36e73066ca334b",
    "rcl_interfaces/msg/Log": "e28ce254ca8abc06abf92773b74602cdbf116ed34fbaf294fb9f81da9f318eac",
    "sensor_msgs/msg/CameraInfo": "b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275",
    "sensor_msgs/msg/Image": "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47",
    "sensor_msgs/msg/Imu": "7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b",
    "sensor_msgs/msg/LaserScan": "64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828",
    "sensor_msgs/msg/MagneticField": "e80f32f56a20486c9923008fc1a1db07bbb273cbbf6a5b3bfa00835ee00e4dff",
    "sensor_msgs/msg/NavSatFix": "62223ab3fe210a15976021da7afddc9e200dc9ec75231c1b6a557fc598a65404",
    "sensor_msgs/msg/NavSatStatus": "d1ed3befa628e09571bd273b888ba1c1fd187c9a5e0006b385d7e5e9095a3204",
    "sensor_msgs/msg/Range": "b42b62562e93cbfe9d42b82fe5994dfa3d63d7d5c90a317981703f7388adff3a",
    "sensor_msgs/msg/RegionOfInterest": "ad16bcba5f9131dcdba6fbded19f726f5440e3c513b4fb586dd3027eeed8abb1",
    "sensor_msgs/msg/Temperature": "72514a14126ab9f8a9abec974c78e5610a367b59db5da355ff1fb982d5bad4b8",
    "std_msgs/msg/Header": "f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01",
    "std_msgs/msg/String": "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    "tf2_msgs/msg/TFMessage": "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
}


def definition(name):
    """(type, array, field) of each field; array is "", "[]" or "[N]"."""
    package, _, stem = name.split("/")
    folder = FOLDERS.get(package, ROOT / "messages" / "interfaces" / package)
    lines = (re.sub(r"#.*", "", line).split() for line in (folder / "msg" / f"{stem}.msg").read_text().splitlines())
    for words in lines:
        if words and "=" not in "".join(words):
            kind, array = re.fullmatch(r"([\w/]+)(\[\d*\])?", words[0]).groups()
            if kind not in TYPE_IDS:
                kind = f"{kind.split('/')[0] if '/' in kind else package}/msg/{kind.split('/')[-1]}"
            yield kind, array or "", words[1]


def described(name):
    fields = []
    for kind, array, field in definition(name):
        count = int(array[1:-1] or 0) if array else 0
        offset = 0 if not array else ARRAY if count else SEQUENCE
        fields.append({"name": field, "type": {
            "type_id": TYPE_IDS.get(kind, NESTED) + offset, "capacity": count, "string_capacity": 0,
            "nested_type_name": "" if kind in TYPE_IDS else kind}})
    return {"type_name": name, "fields": fields}


def inside(name):
    found = {kind for kind, _, _ in definition(name) if kind not in TYPE_IDS}
    return found.union(*map(inside, found))


def type_hash(name):
    text = json.dumps({"type_description": described(name),
                       "referenced_type_descriptions": [described(one) for one in sorted(inside(name))]})
    return hashlib.sha256(text.encode()).hexdigest()


@pytest.mark.parametrize("name", HASHES)
def test_type_hash_is_that_of_ros_2(name):
    assert type_hash(name) == HASHES[name]


def test_every_standard_type_is_in_the_table():
    ours = {f"{path.parts[-3]}/msg/{path.stem}" for path in (ROOT / "messages" / "interfaces").glob("*/msg/*.msg")}
    assert {name for name in ours if not name.startswith("rosflight")} | {"tf2_msgs/msg/TFMessage"} == HASHES.keys()
