// SPDX-License-Identifier: BSD-3-Clause
// ./rosflight blackbox at the far end of an emulated board: a fault in flight, the restart, and the record read over the link.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "companion/asio/link_transport.hpp"
#include "flight/project_root.hpp"
#include "flight/test/h7_rig.hpp"

namespace rosflight::flight::testing {
namespace {

constexpr double kCrash_s = 8.0;
constexpr double kTimeout_s = 300.0;  // of simulated time

/// What the sensors measure of a vehicle that stands still.
sim::SensorSamples at_rest(sim::Time t) {
  sim::SensorSamples samples;
  samples.has_imu = samples.has_mag = samples.has_baro = samples.has_diff_pressure = true;
  samples.imu.accel_m_s2 = {0.0F, 0.0F, -9.8F};
  samples.imu.temperature_K = 300.0F;
  samples.mag.field_T = {2e-5F, 0.0F, 4e-5F};
  samples.baro = {t, 101'000.0F, 300.0F};
  samples.diff_pressure = {t, 0.0F, 300.0F};
  return samples;
}

/// Connects a landed board to a serial port of this machine.
class SerialPort {
 public:
  explicit SerialPort(Rig& rig)
      : autopilot_{rig.flight->autopilot()}, now_{rig.flight->now()}, port_{io_, open()} {
    port_.start();
  }
  std::string path() const { return port_.name().substr(port_.name().find('/')); }
  sim::Time now() const { return now_; }

  /// Both directions, and a step of the board.
  void step() {
    io_.restart();
    io_.poll();
    pass_on(port_, autopilot_.link());
    pass_on(autopilot_.link(), port_);
    for (unsigned k = autopilot_.substeps(); k > 0; --k) {
      now_ += Flight::kStep / autopilot_.substeps();
      autopilot_.step(now_, at_rest(now_), nullptr);
    }
  }

 private:
  static std::unique_ptr<companion::Endpoint> open() { return companion::make_pty_endpoint(); }
  static void pass_on(companion::Transport& from, companion::Transport& to) {
    std::array<std::uint8_t, 512> bytes{};
    while (const std::size_t count = from.read(bytes.data(), bytes.size()))
      to.write(bytes.data(), count, companion::kUrgent);
  }

  Autopilot& autopilot_;
  sim::Time now_;
  boost::asio::io_context io_;
  companion::LinkTransport port_;
};

struct Ended {
  std::string said;
  int status{-1};
};

/// Runs ./rosflight blackbox while the board goes on.
Ended blackbox(SerialPort& port, const std::filesystem::path& folder) {
  const std::filesystem::path program =
      project_root() / "build/release/apps/rosflight_ground_tools";
  const std::string command =
      program.string() + " blackbox " + port.path() + " --out " + folder.string() + " 2>&1";
  Ended ended;
  std::atomic<bool> done{false};
  std::thread reader([&] {
    std::FILE* const pipe = ::popen(command.c_str(), "r");
    std::array<char, 256> line{};
    while (pipe != nullptr && std::fgets(line.data(), line.size(), pipe) != nullptr)
      ended.said += line.data();
    if (pipe != nullptr) ended.status = ::pclose(pipe);
    done = true;
  });
  const sim::Time end = port.now() + at_s(kTimeout_s);
  while (!done) {
    if (port.now() < end) port.step();  // afterwards the program ends by its own timeout
  }
  reader.join();
  EXPECT_LT(port.now(), end);
  return ended;
}

std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class BlackboxOf : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Boards, BlackboxOf, ::testing::Values("pixracer_pro", "varmint"),
                         [](const auto& board) { return std::string(board.param); });

TEST_P(BlackboxOf, IsReadByTheCommandAfterAFaultInFlight) {
  FlightChoice choice = on_board({}, GetParam());
  choice.mission = "hop";
  Rig rig{choice};
  rig.run_until(kCrash_s);
  ASSERT_TRUE(view_of(rig).armed);
  ASSERT_GT(rig.height_m(), 1.0);
  rig.flight->autopilot().break_down(rig.flight->now(), Autopilot::Breakdown::kCrash);
  rig.flight->run();
  ASSERT_TRUE(rig.completed()) << rig.flight->runner().failure();
  ASSERT_EQ(chip_of(rig).figures()->resets, 1U);

  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / ("h7_blackbox_" + std::to_string(::getpid()));
  std::filesystem::remove_all(folder);
  SerialPort port{rig};
  const Ended ended = blackbox(port, folder);
  EXPECT_EQ(ended.status, 0) << ended.said;
  const std::size_t first = ended.said.find("(start of the board)");
  ASSERT_NE(first, std::string::npos) << ended.said;
  const std::size_t second = ended.said.find("(start of the board)", first + 1);
  ASSERT_NE(second, std::string::npos) << ended.said;
  EXPECT_NE(ended.said.find("Rearmed after a fault in flight", second), std::string::npos)
      << ended.said;
  EXPECT_NE(ended.said.find("Fault 1 at pc ", second), std::string::npos) << ended.said;
  EXPECT_NE(content(folder / "texts.csv").find("Rearmed after a fault in flight"),
            std::string::npos);
  const std::string moments = content(folder / "record.csv");
  const double flown_s = sim::to_seconds(rig.flight->now()) - kCrash_s;
  EXPECT_GT(std::count(moments.begin(), moments.end(), '\n'), 100.0 * std::min(flown_s, 5.0));
  EXPECT_GT(std::filesystem::file_size(folder / "flight.mcap"), 10'000U);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace rosflight::flight::testing
