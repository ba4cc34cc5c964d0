// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "flight/replay/replay.hpp"
#include "flight/replay/replay_rig.hpp"

namespace rosflight::flight {
namespace {

namespace fs = std::filesystem;

class Replay : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              (std::string("rosflight_replay_") +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string file(const char* name, const std::string& text) {
    const fs::path path = folder_ / name;
    std::ofstream(path) << text;
    return path.string();
  }
  static constexpr const char* kHeader = "time_us,imu_stamp_us,ax,ay,az,gx,gy,gz,event\n";

  void refuses(const ReplayOptions& options, const std::string& part) {
    std::ostringstream out;
    try {
      replay(options, out);
      FAIL() << "was accepted, wanted: " << part;
    } catch (const InputError& e) {
      const std::string text = e.what();
      EXPECT_NE(text.find(part), std::string::npos) << text;
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    }
  }
  void refuses_input(const std::string& text, const std::string& part) {
    ReplayOptions options;
    options.input = file("in.csv", text);
    options.output = (folder_ / "out.csv").string();
    refuses(options, part);
    EXPECT_FALSE(fs::exists(*options.output));
  }

  fs::path folder_;
};

TEST_F(Replay, WritesOneRowPerRowWithAllOutputColumns) {
  ReplayOptions options;
  options.input =
      file("in.csv", std::string(kHeader) + "2500,2500,0,0,-9.80665,0,0,0,\n" + "5000,,,,,,,,\n");
  options.output = (folder_ / "out.csv").string();
  std::ostringstream out;
  EXPECT_EQ(replay(options, out), 0);
  std::ifstream written(*options.output);
  std::string header;
  std::string row;
  std::getline(written, header);
  EXPECT_EQ(header.substr(0, 40), "step,time_us,armed,failsafe,error_codes,");
  int rows = 0;
  while (std::getline(written, row)) ++rows;
  EXPECT_EQ(rows, 2);
  refuses(options, "exists; use --force");
  options.force = true;
  EXPECT_EQ(replay(options, out), 0);
}

TEST_F(Replay, ComparisonFindsADifferenceAndItsRow) {
  ReplayOptions options;
  options.input = file("in.csv", "time_us,armed\n2500,0\n5000,1\n");
  options.compare = true;
  std::ostringstream out;
  EXPECT_EQ(replay(options, out), 1);
  EXPECT_NE(out.str().find("FAILED from row 2"), std::string::npos) << out.str();
  options.waivers = file("w.csv", "column,first_row,last_row,weak_point\narmed,2,2,17\n");
  std::ostringstream waived;
  EXPECT_EQ(replay(options, waived), 0);
  EXPECT_NE(waived.str().find("1 rows waived (weak point 17)"), std::string::npos) << waived.str();
}

TEST_F(Replay, EventsGoThroughTheLink) {
  ReplayOptions options;
  options.input = file("in.csv",
                       "time_us,event,out9\n2500,PARAM PRIMARY_MIXER=2;AUX 9:S:1.0,0\n"
                       "5000,BARO 101325,0\n");
  options.compare = true;
  std::ostringstream out;
  EXPECT_EQ(replay(options, out), 0) << out.str();
}

/// Rows of a vehicle at rest, 400 Hz, with a receiver frame every 20 ms; the switch on channel 4
/// arms.
class RestingVehicle {
 public:
  static constexpr int kStep_us = 2500;
  static constexpr int kFrameEvery = 8;

  void set_arm_switch(bool on) { arm_ = on; }
  void add(int rows) {
    for (int k = 0; k < rows; ++k) add_row("");
  }
  /// @returns the row's number, from 1.
  int add_event(const std::string& event) {
    add_row(event);
    return rows_;
  }
  std::string table() const {
    return "time_us,imu_stamp_us,ax,ay,az,gx,gy,gz,rc_new,rc0,rc1,rc2,rc3,rc4,rc5,rc6,rc7,event\n" +
           text_;
  }

 private:
  void add_row(const std::string& event) {
    const std::string time = std::to_string(++rows_ * kStep_us);
    const bool frame = rows_ % kFrameEvery == 0;
    // The last digit of the sample changes, as a real sensor's does.
    text_ += time + "," + time + ",0,0.0" + std::to_string(1 + rows_ % 3) + ",-9.80665,0,0,0," +
             (frame ? "1" : "0") + ",0.5,0.5,0,0.5," + (arm_ ? "1" : "0") + ",0,0,0," + event +
             "\n";
  }
  std::string text_;
  int rows_{0};
  bool arm_{false};
};

/// Cells of one column of a replay's output, row 1 first.
std::vector<std::string> column_of(const std::string& csv, const std::string& name) {
  std::istringstream lines(csv);
  std::string line;
  std::vector<std::string> cells;
  std::size_t wanted = std::string::npos;
  while (std::getline(lines, line)) {
    std::istringstream row(line);
    std::string cell;
    for (std::size_t k = 0; std::getline(row, cell, ','); ++k) {
      if (wanted == std::string::npos && cell == name) wanted = k;
      if (k == wanted && cell != name) cells.push_back(cell);
    }
  }
  return cells;
}

TEST_F(Replay, OutputsAreThoseWrittenAlsoInTheRowThatRebuildsAMixer) {
  RestingVehicle rows;
  const std::string params = file("p.csv",
                                  "order,param,type,value\n1,PRIMARY_MIXER,int,2\n"
                                  "2,FAILSAFE_THR,float,0.25\n3,RC_ARM_CHN,int,4\n"
                                  "4,ACC_X_BIAS,float,0.001\n");
  rows.add_event("AUX 9:S:1.0");
  rows.add(200);
  const int rebuilt = rows.add_event("PARAM PRIMARY_MIXER=1");
  rows.add(3);
  rows.add_event("PARAM PRIMARY_MIXER=2");
  rows.add(1600);
  rows.set_arm_switch(true);
  rows.add(1200);
  const int refused = rows.add_event("PARAM PRIMARY_MIXER=1");
  rows.add(3);
  const std::string csv =
      replay({CsvTable(file("in.csv", rows.table())), std::make_unique<CsvTable>(params), nullptr},
             false)
          .csv;
  const auto servo = column_of(csv, "out9");
  const auto motor = column_of(csv, "out0");
  const auto armed = column_of(csv, "armed");
  ASSERT_GT(servo.size(), static_cast<std::size_t>(refused + 2));
  const auto at = [](int row) { return static_cast<std::size_t>(row - 1); };
  // The firmware writes the outputs of the new mixer at once, servos at their centre; the sample
  // after it brings the auxiliary command back.
  for (int row = rebuilt - 1; row <= rebuilt + 5; ++row) {
    const bool rebuilding = row == rebuilt || row == rebuilt + 4;
    EXPECT_EQ(servo[at(row)], rebuilding ? "0.5" : "1") << row;
  }
  ASSERT_EQ(armed[at(refused)], "1");
  for (int row = refused - 1; row <= refused + 2; ++row) {
    EXPECT_EQ(servo[at(row)], "1") << row;
    EXPECT_EQ(std::stof(motor[at(row)]), 0.1f) << row;
  }
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): the input owns its tables
}

TEST_F(Replay, OutputsOfABoardThatRestartsAreOff) {
  // The board's outputs, not the mixer's, which still has the servo where it was.
  RestingVehicle rows;
  rows.add_event("PARAM PRIMARY_MIXER=2;AUX 9:S:1.0");
  rows.add(10);
  ReplayRig rig;
  const CsvTable table(file("in.csv", rows.table()));
  for (std::size_t row = 0; row < table.rows(); ++row) rig.step(table, row);
  EXPECT_EQ(rig.output("out9"), "1");
  rig.board().outputs.disable();
  EXPECT_EQ(rig.output("out9"), "0");
}

TEST_F(Replay, BadTablesAreRefusedWithFileLineAndColumn) {
  refuses_input("", "no header line");
  refuses_input("time_us\n2500,1\n", "in.csv:2: found 2 cells, allowed 1");
  refuses_input("time_us,flavour\n2500,1\n", "found column 'flavour'");
  refuses_input("time_us,time_us\n1,1\n", "twice");
  refuses_input("step\n1\n", "no column time_us");
  refuses_input("time_us\nsoon\n", "in.csv:2: column time_us: found 'soon'");
  refuses_input("time_us\n5000\n2500\n",
                "in.csv:3: column time_us: found 2500, allowed 5000 or later");
  refuses_input("time_us,imu_stamp_us,ax\n1,1,nan\n", "column ax: found 'nan'");
  refuses_input("time_us,imu_stamp_us,ax\n1,1,1e99\n", "column ax: found '1e99'");
  refuses_input(std::string("time_us\n1\0\n", 10), "not a text file");
  refuses_input("time_us,event\n1,DANCE\n", "found 'DANCE', allowed CAL_IMU");
  refuses_input("time_us,event\n1,PARAM RC_MAX_THR\n", "allowed PARAM NAME=NUMBER");
  refuses_input("time_us,event\n1,PARAM NO_SUCH=1\n", "NO_SUCH");
  refuses_input("time_us,event\n1,PARAM RC_MAX_THR=7\n", "allowed 0..1");
  refuses_input("time_us,event\n1,AUX 20:S:1\n", "index 0..13");
}

TEST_F(Replay, BadParameterAndWaiverFilesAreRefused) {
  ReplayOptions options;
  options.input = file("in.csv", "time_us,armed\n1,0\n");
  options.compare = true;
  options.params = file("p.csv", "order,param,type,value\n1,RC_MAX_THR,double,1\n");
  refuses(options, "p.csv:2: column type: found 'double'");
  options.params = file("p.csv", "a,b\n1,2\n");
  refuses(options, "allowed order,param,type,value");
  options.params = folder_ / "missing.csv";
  refuses(options, "missing.csv: cannot be read");
  options.params.reset();
  options.waivers = file("w.csv", "column,first_row,last_row,weak_point\nmood,1,2,3\n");
  refuses(options, "found 'mood', allowed an output column");
  options.waivers = file("w.csv", "column,first_row,last_row,weak_point\narmed,1,2,78\n");
  refuses(options, "allowed 0..77");
}

}  // namespace
}  // namespace rosflight::flight
