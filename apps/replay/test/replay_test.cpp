// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "apps/replay/replay.hpp"

namespace rosflight::apps {
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
  refuses(options, "allowed 1..77");
}

}  // namespace
}  // namespace rosflight::apps
