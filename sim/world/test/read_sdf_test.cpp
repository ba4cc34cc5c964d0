// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/read_sdf.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "config/strict_yaml.hpp"
#include "sim/world/xml.hpp"

namespace rosflight::sim::world {
namespace {

std::filesystem::path file() {
  return std::filesystem::path(::testing::TempDir()) / "read_sdf_test.sdf";
}
WorldShapes world_of(const std::string& text) {
  std::ofstream(file()) << text;
  return read_sdf_world(file());
}
/// A world with one collision.
std::string with(const std::string& geometry, const std::string& pose = "",
                 const std::string& model = "") {
  return "<sdf version='1.9'><world name='w'>\n<model name='m'><static>true</static>" + model +
         "<link name='l'><collision name='c'>" + pose + "\n<geometry>" + geometry +
         "</geometry></collision></link></model></world></sdf>";
}
std::string refusal(const std::string& text) {
  try {
    world_of(text);
  } catch (const config::Error& error) {
    return std::string(error.what()).substr(file().string().size());
  }
  return "nothing";
}
double distance_m(const WorldShapes& world, const Vector3& origin_W, const Vector3& direction_W) {
  return world.cast({origin_W, direction_W}).distance_m;
}

TEST(SdfWorld, TheWorldOfTheGazeboTestsIsWhereItsCommentSaysItIs) {
  const WorldShapes world = read_sdf_world("flight/gazebo/test/worlds/field.sdf");
  ASSERT_EQ(world.shapes().size(), 4U);
  EXPECT_EQ(world.shapes()[1].name, "model house, link link, collision walls");
  const Vector3 start_W(0.0, 0.0, -2.0);
  EXPECT_NEAR(distance_m(world, start_W, {0.0, 0.0, 1.0}), 2.0, 1e-12);   // level ground
  EXPECT_NEAR(distance_m(world, start_W, {1.0, 0.0, 0.0}), 20.0, 1e-12);  // a house 20 m north
  EXPECT_NEAR(distance_m(world, start_W, {0.0, 1.0, 0.0}), 29.8, 1e-12);  // a mast 30 m east
  // The hill's foot is 10 m south and it rises 4 m over 30 m: 2 m high 15 m behind the foot.
  EXPECT_NEAR(distance_m(world, start_W, {-1.0, 0.0, 0.0}), 25.0, 1e-9);
  EXPECT_EQ(distance_m(world, start_W, {0.0, -1.0, 0.0}), kNoHit_m);
}

TEST(SdfWorld, PosesOfModelLinkAndCollisionAddUp) {
  const std::string text =
      "<sdf version='1.9'><world name='w'><light name='sun'/><model "
      "name='m'><static>1</static><pose>10 0 0 0 0 1.5707963267948966</pose>"
      "<link name='l'><pose degrees='true'>5 0 0 0 0 90</pose><collision name='c'><pose>2 0 1 0 0 "
      "0</pose>"
      "<geometry><box><size>1 0.2 "
      "1</size></box></geometry></collision></link></model></world></sdf>";
  // SDF's axes are east, north, up: 10 m east, then 5 m along its x, which is north, then 2 m along -east.
  const WorldShapes world = world_of(text);
  const Vector3& p_W = world.shapes().at(0).p_WS;
  EXPECT_TRUE(p_W.isApprox(Vector3(5.0, 8.0, -1.0), 1e-12)) << p_W.transpose();
  EXPECT_NEAR(distance_m(world, {5.0, 0.0, -1.0}, {0.0, 1.0, 0.0}), 7.5,
              1e-12);  // 1 m long along east
  EXPECT_NEAR(distance_m(world, {0.0, 8.0, -1.0}, {1.0, 0.0, 0.0}), 4.9,
              1e-12);  // 0.2 m along north
}

TEST(SdfWorld, APlaneStandsOnItsNormal) {
  const WorldShapes world =
      world_of(with("<plane><normal>1 0 0</normal></plane>", "<pose>7 0 0 0 0 0</pose>"));
  EXPECT_NEAR(distance_m(world, {3.0, 0.0, -3.0}, {0.0, 1.0, 0.0}), 7.0, 1e-12);
  EXPECT_EQ(distance_m(world, {3.0, 0.0, -3.0}, {0.0, 0.0, 1.0}), kNoHit_m);
}

TEST(SdfWorld, ReadsSphereCylinderMeshAndHeightMap) {
  EXPECT_NEAR(distance_m(world_of(with("<sphere><radius>2</radius></sphere>")), {9.0, 0.0, 0.0},
                         {-1.0, 0.0, 0.0}),
              7.0, 1e-12);
  // Roll by 90 degrees lays a cylinder along north.
  const auto lying = world_of(with("<cylinder><radius>0.5</radius><length>6</length></cylinder>",
                                   "<pose degrees='1'>0 0 0 90 0 0</pose>"));
  EXPECT_NEAR(distance_m(lying, {9.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}), 6.0, 1e-12);
  const auto folder = file().parent_path();
  std::ofstream(folder / "read_sdf.asc") << "ncols 2\nnrows 2\ncellsize 100\n1 1\n1 1\n";
  const auto terrain =
      world_of(with("<heightmap><uri>file://read_sdf.asc</uri><pos>0 0 4</pos></heightmap>"));
  EXPECT_NEAR(distance_m(terrain, {20.0, -30.0, -9.0}, {0.0, 0.0, 1.0}), 4.0, 1e-9);
  std::ofstream(folder / "read_sdf.obj") << "v -50 -50 0\nv 50 -50 0\nv 0 50 0\nf 1 2 3\n";
  const auto mesh = world_of(with("<mesh><uri>model://read_sdf.obj</uri></mesh>"));
  EXPECT_NEAR(distance_m(mesh, {0.0, 0.0, -9.0}, {0.0, 0.0, 1.0}), 9.0, 1e-12);
}

TEST(SdfWorld, WhatCannotBeReadIsOneLine) {
  EXPECT_EQ(refusal(with("<capsule/>")),
            ":3: world, model m, link l, collision c, geometry: found capsule, allowed box, "
            "cylinder, heightmap, mesh, plane or sphere");
  EXPECT_EQ(
      refusal(with("<sphere><radius>-2</radius></sphere>")),
      ":3: world, model m, link l, collision c, geometry: found radius -2, allowed a number > 0");
  EXPECT_EQ(refusal(with("<sphere/>")),
            ":3: world, model m, link l, collision c, geometry: found sphere without radius, "
            "allowed one with radius");
  EXPECT_EQ(
      refusal(with("<box><size>1 2</size></box>")),
      ":3: world, model m, link l, collision c, geometry: found size '1 2', allowed 3 numbers");
  EXPECT_EQ(
      refusal(with("<box><size>1 2 3 4</size></box>")),
      ":3: world, model m, link l, collision c, geometry: found size '1 2 3 4', allowed 3 numbers");
  EXPECT_EQ(refusal(with("<mesh><uri>house.dae</uri></mesh>")),
            ":3: world, model m, link l, collision c, geometry: found uri house.dae, allowed a "
            "file *.obj");
  EXPECT_EQ(refusal(with("<mesh><uri>gone.obj</uri></mesh>")),
            ":3: world, model m, link l, collision c, geometry: found uri gone.obj, allowed a file "
            "that is there, such as in the folder of the world");
  EXPECT_EQ(refusal(with("<sphere><radius>1</radius></sphere>",
                         "<pose relative_to='x'>0 0 0 0 0 0</pose>")),
            ":2: world, model m, link l, collision c: found pose with relative_to x, allowed x y z "
            "roll pitch yaw from the parent");
  EXPECT_EQ(refusal("<sdf version='1.9'><world name='w'>\n<model name='m'/></world></sdf>"),
            ":2: world, model m: found a model that moves, allowed <static>true</static>");
  EXPECT_EQ(refusal("<sdf version='1.9'><world name='w'>\n<include/></world></sdf>"),
            ":2: world: found include, allowed model");
  EXPECT_EQ(refusal("<robot/>"), ":1: sdf: found robot, allowed sdf");
  EXPECT_EQ(refusal("<sdf version='1.9'></sdf>"), ":1: sdf: found no world, allowed one");
}

TEST(SdfWorld, AMissingFileIsOneLine) {
  EXPECT_THROW(
      {
        try {
          read_sdf_world("/nowhere/field.sdf");
        } catch (const config::Error& error) {
          EXPECT_STREQ(error.what(), "/nowhere/field.sdf: found no such file");
          throw;
        }
      },
      config::Error);
}

std::string xml_refusal(const std::string& text) {
  try {
    read_xml(text, "f");
  } catch (const config::Error& error) {
    return error.what();
  }
  return "nothing";
}

TEST(Xml, ReadsElementsTextAndEntities) {
  const XmlElement root = read_xml(
      "<?xml version='1.0'?>\n<!-- a > b -->\n<a b=\"1 &lt; 2\" c='&#65;'>\n "
      "x<d/>&amp;<![CDATA[<y>]]> </a>\n",
      "f");
  EXPECT_EQ(root.name, "a");
  EXPECT_EQ(root.line, 3);
  EXPECT_EQ(root.attributes.at("b"), "1 < 2");
  EXPECT_EQ(root.attributes.at("c"), "A");
  EXPECT_EQ(root.text, "x&<y>");
  ASSERT_NE(root.child("d"), nullptr);
  EXPECT_EQ(root.child("d")->line, 4);
  EXPECT_EQ(root.child("e"), nullptr);
}

TEST(Xml, RefusesWithLineFoundAndAllowed) {
  const auto malformed = [](const char* line, const char* name) {
    return std::string("f:") + line + ": found no well-formed XML (XML_" + name +
           "), allowed XML 1.0 in UTF-8";
  };
  EXPECT_EQ(xml_refusal(""), malformed("1", "ERROR_EMPTY_DOCUMENT"));
  EXPECT_EQ(xml_refusal("<!-- only -->"), "f:1: found no element, allowed one");
  EXPECT_EQ(xml_refusal("<a>\n<b>\n</a>"), malformed("2", "ERROR_MISMATCHED_ELEMENT"));
  EXPECT_EQ(xml_refusal("<a b=1/>"), malformed("1", "ERROR_PARSING_ATTRIBUTE"));
  EXPECT_EQ(xml_refusal("<a b='1' b='2'/>"), malformed("1", "ERROR_PARSING_ATTRIBUTE"));
  EXPECT_EQ(xml_refusal("<a/>\n<b/>"), "f:2: found more than one root element, allowed one");
  EXPECT_EQ(xml_refusal("<!DOCTYPE a><a/>"),
            "f:1: found '<!DOCTYPE a>', allowed elements and comments");
  EXPECT_EQ(xml_refusal("<a>\n<!-- "), malformed("2", "ERROR_PARSING_COMMENT"));
  std::string deep;  // deeper than a stack may be
  for (int k = 0; k < 2000; ++k) deep += "<a>";
  EXPECT_EQ(xml_refusal(deep), malformed("1", "ELEMENT_DEPTH_EXCEEDED"));
}

TEST(Xml, EveryCutFileIsRefusedNotCrashed) {
  const std::string whole =
      with("<box><size>1 2 3</size></box>", "<pose degrees='1'>0 0 0 90 0 0</pose>");
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(xml_refusal(whole.substr(0, size)), "nothing") << size;
  EXPECT_EQ(xml_refusal(whole), "nothing");
}

}  // namespace
}  // namespace rosflight::sim::world
