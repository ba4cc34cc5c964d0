// SPDX-License-Identifier: BSD-3-Clause
#include "apps/sdf_command.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "config/strict_yaml.hpp"

namespace rosflight::apps {
namespace {

std::string message_of(const SdfOptions& options) {
  std::ostringstream out;
  try {
    sdf_command(options, out);
  } catch (const std::exception& error) {
    EXPECT_TRUE(out.str().empty());
    return error.what();
  }
  return "no error";
}

TEST(SdfCommand, WritesTheSameToAFileAndToStandardOutput) {
  const auto file = std::filesystem::path(testing::TempDir()) / "rosflight_sdf_command.sdf";
  std::filesystem::remove(file);
  SdfOptions options;
  options.vehicle = "multirotor";
  std::ostringstream printed;
  EXPECT_EQ(sdf_command(options, printed), 0);
  options.output = file;
  std::ostringstream nothing;
  EXPECT_EQ(sdf_command(options, nothing), 0);
  EXPECT_TRUE(nothing.str().empty());
  std::ifstream in(file);
  const std::string written{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ(written, printed.str());
  EXPECT_NE(written.find("<sdf version=\"1.9\">"), std::string::npos);
  EXPECT_EQ(message_of(options), file.string() + ": exists; use --force to replace it");
  options.force = true;
  EXPECT_EQ(message_of(options), "no error");
  std::filesystem::remove(file);
}

TEST(SdfCommand, AnOverrideIsInTheModel) {
  SdfOptions options;
  options.vehicle = "anaconda";
  options.overrides = {"vehicle.body.mass_kg=5"};
  std::ostringstream out;
  sdf_command(options, out);
  // Less four joints of 10 mg.
  EXPECT_NE(out.str().find("<mass>4.99996</mass>"), std::string::npos) << out.str();
}

TEST(SdfCommand, WritesAWorldWithThePlugin) {
  SdfOptions options;
  options.vehicle = "multirotor";
  options.world = "fortress";
  options.plugin = {"mode=whole_loop", "mission=hop"};
  options.overrides = {"vehicle.body.mass_kg=5"};
  std::ostringstream out;
  sdf_command(options, out);
  const std::string text = out.str();
  for (const std::string part :
       {"<mode>whole_loop</mode>", "<mission>hop</mission>", "<set>body.mass_kg=5</set>",
        "/vehicles/multirotor.yaml</vehicle>", "<max_step_size>0.0025</max_step_size>"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  options.plugin = {"mode=half"};
  EXPECT_EQ(message_of(options), "<mode>: found 'half', allowed dynamics_only, whole_loop");
  options.plugin = {"half"};
  EXPECT_EQ(message_of(options), "element of the plugin: found 'half', allowed NAME=VALUE");
  options.world.clear();
  EXPECT_EQ(message_of(options), "--plugin: found without --world, allowed with it");
}

TEST(SdfCommand, RefusesInOneLine) {
  SdfOptions options;
  options.vehicle = "kite";
  EXPECT_NE(message_of(options).find("vehicle: found kite, allowed"), std::string::npos);
  options.vehicle = "multirotor";
  options.output = "/nowhere/model.sdf";
  EXPECT_NE(message_of(options).find("/nowhere/model.sdf"), std::string::npos);
}

}  // namespace
}  // namespace rosflight::apps
