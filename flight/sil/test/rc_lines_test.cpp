// SPDX-License-Identifier: BSD-3-Clause
#include "flight/sil/rc_lines.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <sstream>
#include <string>
#include <string_view>

namespace rosflight::flight {
namespace {

using sim::rc::Control;

std::array<int, 2> make_pipe() {
  std::array<int, 2> ends{};
  EXPECT_EQ(::pipe(ends.data()), 0);
  return ends;
}

class RcLinesTest : public testing::Test {
 protected:
  ~RcLinesTest() override {
    for (const int fd : ends_) ::close(fd);
  }
  void type(std::string_view text) {
    ASSERT_EQ(::write(ends_[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  /// In the next frame of the transmitter.
  float position(Control control) {
    lines_.step();
    hal::RcFrame frame;
    constexpr sim::Time kFrame{20'000};
    pilot_.step(t_ += kFrame, frame);
    return *pilot_.position(control);
  }

  std::array<int, 2> ends_{make_pipe()};
  sim::rc::Pilot pilot_;
  std::ostringstream err_;
  RcLines lines_{ends_[0], pilot_, err_};
  sim::Time t_{};
};

TEST_F(RcLinesTest, EachLineMovesItsControlWhenItsEndHasCome) {
  EXPECT_EQ(position(Control::kRoll), 0.5F) << "nothing has come, and nothing waits";
  type("roll 1\nthro");
  EXPECT_EQ(position(Control::kRoll), 1.0F);
  EXPECT_EQ(position(Control::kThrottle), 0.0F);
  type("ttle 0.25\narm 1\n");
  EXPECT_EQ(position(Control::kThrottle), 0.25F);
  EXPECT_EQ(position(Control::kArm), 1.0F);
  EXPECT_EQ(err_.str(), "");
}

TEST_F(RcLinesTest, AnotherLineIsNamedWithWhatIsAllowedAndMovesNothing) {
  for (const char* line :
       {"", "roll", "roll ", "roll 1.1", "roll -0.1", "roll nan", "rol 1", " roll 1"}) {
    err_.str("");
    type(std::string(line) + "\n");
    EXPECT_EQ(position(Control::kRoll), 0.5F) << line;
    const std::string start =
        "rosflight: --rc -: found '" + std::string(line) + "', allowed CONTROL";
    EXPECT_TRUE(err_.str().starts_with(start)) << err_.str();
    EXPECT_EQ(err_.str().find('\n'), err_.str().size() - 1);
  }
}

TEST_F(RcLinesTest, ALineWithoutEndIsNotKeptForEver) {
  type(std::string(4000, 'x'));
  lines_.step();
  type("\nroll 0\n");
  EXPECT_EQ(position(Control::kRoll), 0.0F);
  EXPECT_LT(err_.str().size(), 400U);
}

TEST_F(RcLinesTest, AfterTheEndOfTheInputTheSticksStay) {
  type("yaw 0.75\n");
  ::close(ends_[1]);
  EXPECT_EQ(position(Control::kYaw), 0.75F);
  EXPECT_EQ(position(Control::kYaw), 0.75F);
  ends_[1] = ::dup(ends_[0]);  // for the destructor
}

}  // namespace
}  // namespace rosflight::flight
