// SPDX-License-Identifier: BSD-3-Clause
// Memory of the firmware: size of one object with its link adapter, and allocations on the
// firmware's side of a whole flight after construction.
#include <cstdio>
#include <memory>

#include "apps/fly/flight.hpp"
#include "test_support/allocations.hpp"

namespace {

using namespace rosflight;  // NOLINT(google-build-using-namespace): a program of one file

/// Counts while the firmware runs.
class CountingBoard final : public sim::BoardModule {
 public:
  explicit CountingBoard(apps::FirmwareBoard& board) : board_{board} {}
  const hal::OutputValues& step(sim::Time t, const sim::SensorSamples& samples,
                                const hal::RcFrame* rc) override {
    const std::size_t before = test_support::allocations();
    const hal::OutputValues& outputs = board_.step(t, samples, rc);
    allocations_ += test_support::allocations() - before;
    return outputs;
  }
  bool armed() const override { return board_.armed(); }
  std::size_t allocations() const { return allocations_; }

 private:
  apps::FirmwareBoard& board_;
  std::size_t allocations_{0};
};

}  // namespace

int main() {
  try {
    const auto setup = std::make_unique<apps::FlightSetup>(apps::FlightChoice{});
    const auto flight = std::make_unique<apps::Flight>(*setup);
    CountingBoard counting(flight->board());
    flight->replace_board(counting);
    flight->run();
    if (flight->director().stage() != apps::Stage::kDone) {
      std::fprintf(stderr, "sizes: the flight failed: %s\n", flight->director().failure().c_str());
      return 1;
    }
    std::printf("{\"firmware.object_bytes\": %zu, \"firmware.heap_allocations\": %zu}\n",
                sizeof(core::Firmware) + sizeof(link::MavlinkCodec), counting.allocations());
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "sizes: %s\n", e.what());
    return 1;
  }
}
