// SPDX-License-Identifier: BSD-3-Clause
// The example of companion/README.md compiles as printed there.
#include <gtest/gtest.h>

#include <fstream>
#include <iostream>
#include <sstream>

#include "companion/asio/runner.hpp"
#include "link/detect/detecting_codec.hpp"

namespace rosflight::companion {
namespace {

// clang-format off
void example() {
    rosflight::link::DetectingCodec codec;  // MAVLink or lean, as the FCU speaks
    Runner runner(codec, parse_link("serial:/dev/ttyACM0:921600"), {});
    runner.on_link_state([](bool, const std::string& line) { std::cerr << line << '\n'; });
    Session& session = runner.session();
    Job<LoadReport> load = session.parameters().load_file("multirotor.yaml");
    load.when_finished([&] {
      std::cout << load.text() << '\n';
      Job<CommandResult> imu = session.commands().start(rosflight::link::Command::kAccelCalibration);
      imu.when_finished([&, imu] {
        std::cout << imu.text() << '\n';  // "IMU calibration: IMU offsets captured"
        runner.stop();
      });
    });
    runner.run();  // the link may appear later; a taken port throws LinkError
}
// clang-format on

std::string content(const char* path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(Readme, ExampleIsTheCompiledOne) {
  static_cast<void>(&example);  // waits for a device: not run here
  const std::string source = content("companion/test/readme_test.cpp");
  const std::size_t begin = source.find("void example() {\n") + 17;
  const std::string body = source.substr(begin, source.find("\n}\n", begin) - begin);
  ASSERT_GT(body.size(), 500U);
  EXPECT_NE(content("companion/README.md").find(body), std::string::npos);
}

}  // namespace
}  // namespace rosflight::companion
