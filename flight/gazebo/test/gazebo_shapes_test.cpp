// SPDX-License-Identifier: BSD-3-Clause
// What a world of SDF can be made of: each shape carries a body, and what dartsim does not make of it is one line.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "flight/gazebo/gazebo_engine.hpp"
#include "flight/gazebo/test/gazebo_rig.hpp"

namespace rosflight::flight {
namespace {

using sim::BodyState;

constexpr double kHalfCrate_m = 0.1;

/// A body of the world that is 1 m high at the origin, where a crate can stand on it.
struct Stand {
  const char* name;
  std::string pose;      ///< Six numbers.
  std::string geometry;  ///< SDF.
};

std::ostream& operator<<(std::ostream& out, const Stand& stand) {
  return out << stand.name;
}

std::string mesh(const std::string& file, const std::string& more = "") {
  return "<mesh><uri>" + file + "</uri>" + more + "</mesh>";
}

constexpr const char* kSquareStl =
    "solid square\n"
    "facet normal 0 0 1\nouter loop\nvertex -30 -30 0\nvertex 30 -30 0\nvertex 30 30 0\n"
    "endloop\nendfacet\n"
    "facet normal 0 0 1\nouter loop\nvertex -30 -30 0\nvertex 30 30 0\nvertex -30 30 0\n"
    "endloop\nendfacet\nendsolid square\n";

/// @param indices  of two triangles.
std::string square_dae(const std::string& indices = "0 1 2 0 2 3") {
  return "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' "
         "version='1.4.1'><asset><unit meter='1'/><up_axis>Z_UP</up_axis></asset>"
         "<library_geometries><geometry id='g' name='g'><mesh><source id='p'>"
         "<float_array id='pa' count='12'>-30 -30 0 30 -30 0 30 30 0 -30 30 0</float_array>"
         "<technique_common><accessor source='#pa' count='4' stride='3'><param name='X' "
         "type='float'/><param name='Y' type='float'/><param name='Z' type='float'/></accessor>"
         "</technique_common></source><vertices id='v'><input semantic='POSITION' source='#p'/>"
         "</vertices><triangles count='2'><input semantic='VERTEX' source='#v' offset='0'/><p>" +
         indices +
         "</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>"
         "<visual_scene id='s'><node id='n'><instance_geometry url='#g'/></node></visual_scene>"
         "</library_visual_scenes><scene><instance_visual_scene url='#s'/></scene></COLLADA>";
}

class Stands : public WithGazebo, public testing::WithParamInterface<Stand> {
 protected:
  void SetUp() override {
    WithGazebo::SetUp();
    if (IsSkipped()) return;
    test_file_of("square.obj", kSquareObj);
    test_file_of("square.stl", kSquareStl);
    test_file_of("square.dae", square_dae());
  }
  static std::string test_file_of(const std::string& name, const std::string& text) {
    const std::filesystem::path file =
        std::filesystem::path(testing::TempDir()) / "gazebo_stands" / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
    return file;
  }
  std::string world() const {
    return test_file_of(std::string(GetParam().name) + ".sdf",
                        "<sdf version='1.9'><world name='w'>" + plane() +
                            solid("stand", GetParam().pose, GetParam().geometry) +
                            "</world></sdf>");
  }
};

TEST_P(Stands, CarryACrate) {
  GazeboEngine engine(crate(), 9.80665, field(world()));
  engine.set_state(at(0.0, 0.0, 1.0 + kHalfCrate_m + 0.002));
  for (int k = 0; k < 200; ++k) engine.step(0.0025, {});
  ASSERT_TRUE(engine.contact()->touches);
  EXPECT_TRUE(engine.contact()->carries);
  EXPECT_EQ(engine.contact()->other, "stand");
  EXPECT_NEAR(-engine.state().p_W.z(), 1.0 + kHalfCrate_m, 0.006);
  EXPECT_NEAR(engine.contact()->normal_up, 1.0, 0.01);
}

/// Those that are solid; a mesh is a surface, and inside of it is room.
class Solids : public Stands {};

TEST_P(Solids, HaveRoomForOneBodyOnly) {
  const std::string said = gazebo_complaint(
      field(world()), [](GazeboEngine& engine) { engine.set_state(at(0.0, 0.0, 0.7)); }, crate());
  EXPECT_EQ(said.rfind("--physics gazebo: the vehicle is inside stand of the world, ", 0), 0U)
      << said;
}

const auto kSolids = testing::Values(
    Stand{"box", "0 0 0.5 0 0 0", "<box><size>4 4 1</size></box>"},
    Stand{"sphere", "0 0 0 0 0 0", "<sphere><radius>1</radius></sphere>"},
    Stand{"cylinder", "0 0 0.5 0 0 0", "<cylinder><radius>2</radius><length>1</length></cylinder>"},
    Stand{"capsule", "0 0 0 0 0 0", "<capsule><radius>0.5</radius><length>1</length></capsule>"},
    Stand{"plane", "0 0 1 0 0 0", "<plane><normal>0 0 1</normal></plane>"});
const auto kSurfaces = testing::Values(
    Stand{"ellipsoid", "0 0 0 0 0 0", "<ellipsoid><radii>3 2 1</radii></ellipsoid>"},
    Stand{"obj", "0 0 1 0 0 0", mesh("square.obj")},
    Stand{"stl", "0 0 1 0 0 0", mesh("square.stl")},
    Stand{"dae", "0 0 1 0 0 0", mesh("square.dae")},
    Stand{"scaled_mesh", "0 0 1 0 0 0", mesh("square.obj", "<scale>0.1 0.1 1</scale>")});

std::string name_of(const testing::TestParamInfo<Stand>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(Shapes, Stands, kSolids, name_of);
INSTANTIATE_TEST_SUITE_P(Surfaces, Stands, kSurfaces, name_of);
INSTANTIATE_TEST_SUITE_P(Shapes, Solids, kSolids, name_of);

class GazeboShapes : public WithGazebo {
 protected:
  /// What is said of this world before the vehicle is in it.
  static std::string complaint(const std::string& text) {
    const std::string file = in_world(text);
    const std::string said = gazebo_complaint(field(file), {}, crate());
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    const std::size_t at = said.find(file + ": ");
    return at == std::string::npos ? said : said.substr(at + file.size() + 2);
  }
  /// What the surface at this height is called that a crate at the origin comes to rest on.
  static std::string carried_by(const std::string& text, double height_m) {
    GazeboEngine engine(crate(), 9.80665, field(in_world(text)));
    engine.set_state(at(0.0, 0.0, height_m + kHalfCrate_m + 0.002));
    for (int k = 0; k < 400; ++k) engine.step(0.0025, {});
    EXPECT_NEAR(-engine.state().p_W.z(), height_m + kHalfCrate_m, 0.006);
    return engine.contact()->other;
  }
};

constexpr const char* kAllowed =
    ": found a shape that dartsim does not read from SDF, allowed box, capsule, cylinder, "
    "ellipsoid, mesh, plane, sphere";

TEST_F(GazeboShapes, ThoseThatAreNotMadeAreOneLine) {
  const std::string polyline =
      "<polyline><height>1</height><point>0 0</point><point>1 0</point><point>0 1</point>"
      "</polyline>";
  EXPECT_EQ(complaint(plane() + solid("m", "0 0 0 0 0 0", polyline)),
            std::string("m::l::c") + kAllowed);
  EXPECT_EQ(complaint(plane() + solid("m", "0 0 0 0 0 0", "<empty/>")),
            std::string("m::l::c") + kAllowed);
  EXPECT_EQ(complaint(plane() + solid("m", "0 0 0 0 0 0",
                                      "<heightmap><uri>h.png</uri><size>9 9 9</size></heightmap>")),
            std::string("m::l::c") + kAllowed);
  EXPECT_EQ(complaint(plane() + "<model name='m'><static>true</static><model name='inner'>" +
                      shape(polyline) + "</model></model>"),
            std::string("m::inner::l::c") + kAllowed);
}

TEST_F(GazeboShapes, OfANestedModelCarry) {
  test_file("square.obj", kSquareObj);
  const auto nested = [](const std::string& geometry) {
    return plane() + "<model name='outer'><static>true</static><pose>0 0 1 0 0 0</pose>" +
           "<model name='inner'><pose>0 0 0.5 0 0 0</pose>" + shape(geometry) + "</model></model>";
  };
  EXPECT_EQ(carried_by(nested(mesh("square.obj")), 1.5), "inner");
  EXPECT_EQ(carried_by(nested("<box><size>9 9 0.2</size></box>"), 1.6), "inner");
}

TEST_F(GazeboShapes, ASubmeshIsThatPartAlone) {
  test_file("two.obj",
            "o low\nv -9 -9 1\nv 9 -9 1\nv 9 9 1\nf 1 2 3\nv -9 9 1\nf 1 3 4\n"
            "o high\nv -9 -9 2\nv 9 -9 2\nv 9 9 2\nv -9 9 2\nf 5 6 7\nf 5 7 8\n");
  const auto part = [](const std::string& more) {
    return plane() + solid("parts", "0 0 0 0 0 0", mesh("two.obj", more));
  };
  EXPECT_EQ(carried_by(part(""), 2.0), "parts");
  EXPECT_EQ(carried_by(part("<submesh><name>low</name></submesh>"), 1.0), "parts");
  const std::string high = "<submesh><name>high</name><center>true</center></submesh>";
  EXPECT_EQ(carried_by(solid("parts", "0 0 3 0 0 0", mesh("two.obj", high)), 3.0), "parts");
  const std::string said = complaint(part("<submesh><name>roof</name></submesh>"));
  EXPECT_NE(said.find("two.obj without a submesh roof"), std::string::npos) << said;
}

TEST_F(GazeboShapes, ABrokenMeshIsOneLineThatNamesIt) {
  const auto said_of = [](const std::string& name, const std::string& text) {
    SCOPED_TRACE(name);
    const std::string file = test_file(name, text);
    const std::string said = complaint(plane() + solid("m", "0 0 0 0 0 0", mesh(name)));
    EXPECT_EQ(said.rfind("m::l::c: ", 0), 0U) << said;
    EXPECT_NE(said.find(file), std::string::npos) << said;
    return said.substr(std::min(said.size(), said.find(file) + file.size()));
  };
  EXPECT_EQ(said_of("beyond.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
            ":4: found a face with vertex 4, allowed 1 to 3");
  EXPECT_EQ(said_of("before.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1/1 -2/1 -4/1\n"),
            ":4: found a face with vertex -4/1, allowed 1 to 3");
  EXPECT_EQ(said_of("empty.obj", ""), " that Gazebo cannot read, allowed .obj, .stl and .dae");
  EXPECT_EQ(said_of("image.png", "PNG"), " that Gazebo cannot read, allowed .obj, .stl and .dae");
  std::string nan = kSquareStl;
  nan.replace(nan.find("vertex -30"), 10, "vertex nan");
  EXPECT_EQ(said_of("not_a_number.stl", nan), " with a vertex that is not finite");
  EXPECT_NE(said_of("no_xml.dae", "this is no XML"), "");
  EXPECT_EQ(said_of("beyond.dae", square_dae("0 1 2 0 2 9")),
            ":1: found an index 9 into #v, allowed 0 to 3");
  EXPECT_NE(said_of("cut.dae", square_dae().substr(0, 500)), "");
}

TEST_F(GazeboShapes, ALongPathIsNotCut) {
  const std::string uri = std::string(200, 'd') + "/" + std::string(200, 'e') + ".obj";
  EXPECT_EQ(complaint(plane() + solid("m", "0 0 0 0 0 0", mesh(uri))),
            "m::l::c: found no mesh " + uri);
}

TEST_F(GazeboShapes, OfAnIncludedModelAreFoundBesideIt) {
  test_file("hut/model.config",
            "<model><name>hut</name><sdf version='1.9'>model.sdf</sdf></model>");
  test_file("hut/meshes/roof.obj", kSquareObj);
  const auto model = [](const std::string& uri) {
    test_file("hut/model.sdf",
              "<sdf version='1.9'>" + solid("hut", "0 0 0 0 0 0", mesh(uri)) + "</sdf>");
  };
  const std::string world = "<include><uri>hut</uri><pose>0 0 1 0 0 0</pose></include>" + plane();
  for (const char* uri : {"meshes/roof.obj", "model://hut/meshes/roof.obj"}) {
    model(uri);
    EXPECT_EQ(carried_by(world, 1.0), "hut") << uri;
  }
  GazeboEngine engine(crate(), 9.80665, field(in_world(world)));
  const auto& files = engine.world_files();
  ASSERT_EQ(files.size(), 3U);  // the world, the model, the mesh
  EXPECT_TRUE(files[0].ends_with("world.sdf"));
  EXPECT_TRUE(files[1].ends_with("hut/model.sdf")) << files[1];
  EXPECT_TRUE(files[2].ends_with("hut/meshes/roof.obj")) << files[2];
}

TEST_F(GazeboShapes, AreFoundInTheResourcePath) {
  const std::filesystem::path model = test_file(
      "elsewhere/hut/model.sdf",
      "<sdf version='1.9'>" + solid("hut", "0 0 0 0 0 0", mesh("model://hut/roof.obj")) + "</sdf>");
  test_file("elsewhere/hut/model.config",
            "<model><name>hut</name><sdf version='1.9'>model.sdf</sdf></model>");
  test_file("elsewhere/hut/roof.obj", kSquareObj);
  const std::string world =
      "<include><uri>model://hut</uri><pose>0 0 1 0 0 0</pose></include>" + plane();
  EXPECT_NE(complaint(world).find("model://hut"), std::string::npos);
  ::setenv("GZ_SIM_RESOURCE_PATH", model.parent_path().parent_path().c_str(), 1);
  EXPECT_EQ(carried_by(world, 1.0), "hut");
  ::unsetenv("GZ_SIM_RESOURCE_PATH");
}

/// How far a crate slides on ground [m] that begins at 2 m/s. Both get this element.
double slide_m(const std::string& of_ground, const std::string& of_crate) {
  const auto surface = [](const std::string& mu) {
    return mu.empty() ? mu
                      : "<surface><friction><ode><mu>" + mu + "</mu><mu2>" + mu +
                            "</mu2></ode></friction></surface>";
  };
  const auto with = [&](std::string text, const std::string& mu) {
    return text.replace(text.find("</geometry>"), 11, "</geometry>" + surface(mu));
  };
  GazeboEngine engine(with(crate(), of_crate), 9.80665, field(in_world(with(plane(), of_ground))));
  engine.set_state(at(0.0, 0.0, kHalfCrate_m));
  for (int k = 0; k < 100; ++k) engine.step(0.0025, {});
  BodyState sliding = engine.state();
  sliding.v_B = {0.0, 2.0, 0.0};
  engine.set_state(sliding);
  for (int k = 0; k < 1000; ++k) engine.step(0.0025, {});
  return engine.state().p_W.y() - sliding.p_W.y();
}

TEST_F(GazeboShapes, FrictionIsTheSmallerOfBoth) {
  const auto expected_m = [](double mu) { return 2.0 * 2.0 / (2.0 * mu * 9.80665); };
  EXPECT_NEAR(slide_m("0.3", "0.6"), expected_m(0.3), 0.02);
  EXPECT_NEAR(slide_m("0.6", "0.3"), expected_m(0.3), 0.02);
  EXPECT_NEAR(slide_m("", "0.3"), expected_m(0.3), 0.02);
}

TEST_F(GazeboShapes, AMovingBodyIsPushed) {
  // A box of 1 kg, 1 m north of a crate that flies to the north at 2 m/s.
  const std::string box =
      "<model name='box'><pose>0 1 1 0 0 0</pose><link name='l'><inertial><mass>1</mass>"
      "<inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial><collision "
      "name='c'><geometry><box><size>1 1 2</size></box></geometry></collision></link></model>";
  GazeboEngine engine(crate("body"), 9.80665, field(in_world(plane() + box)));
  engine.set_state(at(-0.5, 0.0, 1.0, {2.0, 0.0, 0.0}));
  const sim::PhysicsEngine::Load hover{{0.0, 0.0, -kWeight}, sim::Vector3::Zero()};
  int steps = 0;
  for (; !engine.contact()->touches && steps < 400; ++steps) engine.step(0.0025, hover);
  EXPECT_EQ(engine.contact()->other, "box");
  for (int k = 0; k < 400; ++k) engine.step(0.0025, hover);
  EXPECT_GT(engine.state().p_W.x(), 0.4);  // a static one would have held it at 0.3 m
}

/// What is said of a start at this height, of which the engine allows 0.5 m above the ground.
std::string start_at(double height_m, const std::string& world) {
  GazeboEngine::Options options = field(in_world(world));
  options.max_height_m = 0.5;
  return gazebo_complaint(
      options, [&](GazeboEngine& engine) { engine.set_state(at(0.0, 0.0, height_m)); }, crate());
}

TEST_F(GazeboShapes, AStartWithoutGroundIsOneLine) {
  test_file("square.obj", kSquareObj);
  const auto terrain = [](double height_m) {
    return solid("terrain", "0 0 " + std::to_string(height_m) + " 0 0 0", mesh("square.obj"));
  };
  EXPECT_EQ(start_at(0.11, terrain(0.0)), "none");
  EXPECT_EQ(start_at(0.2, terrain(5.0)),
            "--physics gazebo: the world has no ground below the vehicle at its start; terrain is "
            "4.80 m above it");
  EXPECT_EQ(start_at(0.2, solid("mast", "9 9 0 0 0 0", "<box><size>1 1 1</size></box>")),
            "--physics gazebo: the world has no ground below the vehicle at its start");
  EXPECT_EQ(start_at(0.2, terrain(-5.0)),
            "--physics gazebo: the vehicle starts 5.20 m above terrain of the world, allowed "
            "0.50 m");
  EXPECT_EQ(start_at(0.2, terrain(5.0) + plane()), "none");  // a roof
  EXPECT_EQ(start_at(0.2, plane("0 0 -0.2 0.1 0.1 0")), "none");
  EXPECT_EQ(start_at(0.2, solid("disc", "0 0 -1 0 0 0",
                                "<cylinder><radius>2</radius><length>1</length></cylinder>")),
            "--physics gazebo: the vehicle starts 0.70 m above disc of the world, allowed 0.50 m");
}

}  // namespace
}  // namespace rosflight::flight
