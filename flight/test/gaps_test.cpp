// SPDX-License-Identifier: BSD-3-Clause
// A link that is silent and a state that is lost, flown by both vehicles: docs/faults.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <utility>

#include "autonomy/common/gap_watch.hpp"
#include "flight/companion_parts.hpp"
#include "flight/test/flight_rig.hpp"

namespace rosflight::flight::testing {
namespace {

/// The project's estimator, which gives no state for a time, or one that is no number.
class Failing final : public StateEstimateSource {
 public:
  Failing(companion::Session& session, const FlightSetup& setup, double from_s, double to_s)
      : session_{session},
        inner_{make_link_estimator(setup, session)},
        from_s_{from_s},
        to_s_{to_s} {}

  autonomy::StateEstimate estimate() const override {
    autonomy::StateEstimate out = inner_->estimate();
    if (fails()) out.v_W.setConstant(std::numeric_limits<double>::quiet_NaN());
    return out;
  }
  const autonomy::estimation::EstimatorHealth& health() const override {
    shown_ = inner_->health();
    if (fails()) shown_.initialised = false;
    return shown_;
  }
  const std::optional<autonomy::Geodetic>& origin() const override { return inner_->origin(); }
  void set_enabled(bool enabled) override { inner_->set_enabled(enabled); }
  void restart() override { inner_->restart(); }

 private:
  bool fails() const {
    const double t_s = companion::to_seconds(session_.now());
    return t_s >= from_s_ && t_s < to_s_;
  }

  companion::Session& session_;
  std::unique_ptr<LinkStateEstimator> inner_;
  double from_s_;
  double to_s_;
  mutable autonomy::estimation::EstimatorHealth shown_;
};

struct Vehicle {
  const char* name;
  double at_s;       ///< In the middle of the mission.
  double home_m;     ///< A return lands within this of the start.
  const char* down;  ///< What is noted when it comes down without a state.
};

/// A flight with its notes. Its pilot keeps a multirotor's altitude of the moments at which a link is cut.
struct Noted {
  explicit Noted(const FlightChoice& choice, std::vector<double> cuts_s, double from_s = 1e9,
                 double to_s = 1e9)
      : rig{choice, parts(choice, from_s, to_s)} {
    rig.flight->runner().set_notify([this](const FlightNote& note) { notes.push_back(note); });
    if (choice.vehicle != "multirotor") return;
    rig.flight->set_script(
        [cuts_s = std::move(cuts_s), next = 0U](Flight& flight, sim::Time t) mutable {
          if (next == cuts_s.size() || sim::to_seconds(t) < cuts_s[next]) return;
          flight.runner().set_keep_altitude(true);
          ++next;
        });
  }
  ~Noted() { rig.flight->runner().set_notify(nullptr); }
  Noted(const Noted&) = delete;
  Noted& operator=(const Noted&) = delete;

  /// Time of the first note that contains a text; infinity: there is none.
  double noted_s(const std::string& text) const {
    for (const FlightNote& note : notes) {
      if (note.text.find(text) != std::string::npos) return sim::to_seconds(note.t);
    }
    return std::numeric_limits<double>::infinity();
  }
  std::string all() const {
    std::string out = rig.flight->score().verdict;
    for (const FlightNote& note : notes)
      out += fmt::format("\n{:.2f} {}: {}", sim::to_seconds(note.t), note.source, note.text);
    return out;
  }

  std::unique_ptr<FlightSetup> setup;
  std::vector<FlightNote> notes;
  Rig rig;

 private:
  FlightParts parts(const FlightChoice& choice, double from_s, double to_s) {
    setup = std::make_unique<FlightSetup>(choice);
    FlightParts out;
    out.estimate_source = [this, from_s, to_s](companion::Session& session) {
      return std::make_unique<Failing>(session, *setup, from_s, to_s);
    };
    return out;
  }
};

class Gaps : public ::testing::TestWithParam<Vehicle> {
 protected:
  static FlightChoice choice(std::vector<std::string> faults = {}) {
    FlightChoice out = Rig::with_faults(std::move(faults));
    out.vehicle = GetParam().name;
    return out;
  }
  static std::string cut(double seconds) {
    return fmt::format("link_cut@{}:{}", GetParam().at_s, seconds);
  }
  static double at_s() { return GetParam().at_s; }
  static void expect_down_softly(const Noted& flight) {
    const FlightScore score = flight.rig.flight->score();
    EXPECT_EQ(score.outcome, Outcome::kLandedElsewhere) << flight.all();
    EXPECT_EQ(flight.rig.flight->runner().stage(), Stage::kDone) << flight.all();
    EXPECT_TRUE(flight.rig.flight->runner().disarmed()) << flight.all();
  }
};

TEST_P(Gaps, ALinkThatIsBackWithinTenSecondsLetsTheMissionGoOn) {
  for (const double gap_s : {2.5, 9.0}) {
    Noted flight(choice({cut(gap_s)}), {at_s()});
    flight.rig.flight->run();
    EXPECT_TRUE(flight.rig.completed()) << flight.all();
    EXPECT_EQ(flight.noted_s("back after more than 10 s"), std::numeric_limits<double>::infinity());
  }
}

TEST_P(Gaps, ALinkThatIsBackLaterLetsItHoldReturnAndLand) {
  for (const double gap_s : {10.5, 20.0}) {
    Noted flight(choice({cut(gap_s)}), {at_s()});
    flight.rig.flight->run();
    expect_down_softly(flight);
    const FlightScore score = flight.rig.flight->score();
    EXPECT_LT(score.landing.distance_m(score.limits), GetParam().home_m) << flight.all();
    const double back_s = at_s() + gap_s;
    EXPECT_NEAR(flight.noted_s("link silent for 10 s"), at_s() + 10.0, 0.1);
    EXPECT_NEAR(flight.noted_s("back after more than 10 s"), back_s, 0.3);
    const double returns_s =
        std::min(flight.noted_s("returns to the start"), flight.noted_s("phase return"));
    EXPECT_GE(returns_s, back_s + autonomy::GapWatch::kHold_s - 0.1) << flight.all();
    EXPECT_LE(returns_s, back_s + autonomy::GapWatch::kHold_s + 2.0) << flight.all();
  }
}

/// His stick stays where it carries the vehicle; what the link was cut in decides how far that is from level flight.
TEST_P(Gaps, WithABlindPilotALongCutEndsInASoftLandingToo) {
  for (const double share : {0.6, 1.0, 1.4}) {
    for (const double gap_s : {10.5, 20.0, 40.0}) {
      Noted flight(choice({fmt::format("link_cut@{}:{}", share * at_s(), gap_s)}), {});
      flight.rig.flight->run();
      SCOPED_TRACE(fmt::format("cut of {} s at {} s", gap_s, share * at_s()));
      const FlightScore score = flight.rig.flight->score();
      EXPECT_EQ(score.outcome, Outcome::kLandedElsewhere) << flight.all();
    }
  }
}

TEST_P(Gaps, ALinkThatStaysSilentIsGivenUpAfterAMinute) {
  Noted flight(choice({cut(600.0)}), {at_s()});
  EXPECT_TRUE(flight.rig.reach(Stage::kFailed));
  EXPECT_EQ(flight.rig.flight->runner().failure(), "link lost in flight");
  const double end_s = sim::to_seconds(flight.rig.flight->now());
  if (flight.rig.flight->truth().on_ground) {
    EXPECT_LT(end_s, at_s() + 60.0) << flight.all();
  } else {
    EXPECT_NEAR(end_s, at_s() + 60.0, 0.2) << flight.all();
    EXPECT_NEAR(flight.noted_s("given up for lost"), at_s() + 60.0, 0.2);
  }
}

TEST_P(Gaps, AStateThatIsLostForAMomentLetsTheMissionGoOn) {
  Noted flight(choice(), {}, at_s(), at_s() + 1.5);
  flight.rig.flight->run();
  EXPECT_TRUE(flight.rig.completed()) << flight.all();
  EXPECT_NEAR(flight.noted_s("state lost"), at_s() + 0.1, 0.05) << flight.all();
  EXPECT_NEAR(flight.noted_s(GetParam().down), at_s() + 0.1, 0.05) << flight.all();
}

TEST_P(Gaps, AStateThatIsLostForGoodEndsInASoftLanding) {
  for (const char* also : {"", "baro", "range"}) {
    std::vector<std::string> faults;
    if (*also != '\0') faults.push_back(fmt::format("{}@{}", also, at_s() - 1.0));
    Noted flight(choice(faults), {}, at_s());
    flight.rig.flight->run();
    expect_down_softly(flight);
    EXPECT_LT(flight.noted_s(GetParam().down), at_s() + 2.0) << flight.all();
  }
}

/// Nothing waits until the stage ends, and where the pilot keeps the altitude every flight ends softly.
TEST_P(Gaps, RandomGapsNeverEndInATimeout) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int number = 0; number < 4; ++number) {
    std::vector<std::string> faults;
    std::vector<double> cuts_s;
    double t_s = 6.0 + at_s() * (0.12 + 0.5 * share(random));
    for (int gap = 0; gap < 3; ++gap) {
      const double length_s = 0.2 * std::pow(200.0, share(random));
      faults.push_back(fmt::format("link_cut@{:.2f}:{:.2f}", t_s, length_s));
      cuts_s.push_back(t_s);
      t_s += length_s + 15.0 * share(random);
    }
    Noted flight(choice(faults), cuts_s, t_s, t_s + 15.0 * share(random));
    flight.rig.flight->run();
    EXPECT_EQ(flight.noted_s("took longer"), std::numeric_limits<double>::infinity())
        << flight.all();
    EXPECT_NE(flight.rig.flight->score().outcome, Outcome::kTimeout) << flight.all();
    EXPECT_NE(flight.rig.flight->score().outcome, Outcome::kCrash) << flight.all();
    EXPECT_NE(flight.rig.flight->score().outcome, Outcome::kHardLanding) << flight.all();
  }
}

INSTANTIATE_TEST_SUITE_P(Vehicles, Gaps,
                         ::testing::Values(Vehicle{"multirotor", 20.0, 3.0, "sinks level"},
                                           Vehicle{"anaconda", 80.0, 50.0, "glides with level"}),
                         [](const auto& vehicle) { return std::string(vehicle.param.name); });

}  // namespace
}  // namespace rosflight::flight::testing
