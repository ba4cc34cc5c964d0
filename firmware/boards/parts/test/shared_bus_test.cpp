// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/shared_bus.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace rosflight::boards::parts {
namespace {

using hal::microseconds;
using hal::milliseconds;

struct FakeClock final : hal::Clock {
  Time now() const override { return time; }
  Time time{};
};

/// Remembers what was begun; the test ends it.
struct FakeHardware final : BusHardware {
  void begin(std::uint8_t device, const Transfer& transfer) override {
    EXPECT_GT(masked, 0) << "the queue is open to interrupts";
    EXPECT_FALSE(running) << "two transfers at once";
    running = true;
    devices.push_back(device);
    last = &transfer;
  }
  void abort() override {
    ++aborts;
    running = false;
  }
  std::uint32_t mask() override { return static_cast<std::uint32_t>(masked++); }
  void unmask(std::uint32_t state) override { masked = static_cast<int>(state); }

  std::vector<std::uint8_t> devices;
  const Transfer* last{};
  int aborts{0};
  int masked{0};
  bool running{false};
};

/// A driver that may start further transfers when one has ended.
struct FakeOwner final : TransferOwner {
  void transfer_done(Transfer& ended, TransferResult result, Time end) override {
    results.push_back(result);
    ends.push_back(end);
    EXPECT_EQ(&ended, &transfer);
    if (again > 0) {
      --again;
      EXPECT_TRUE(port->start(transfer));
    }
  }
  std::uint8_t byte{0x75};
  Transfer transfer{&byte, 1, nullptr, 0, this};
  Port* port{};
  int again{0};
  std::vector<TransferResult> results;
  std::vector<Time> ends;
};

class SharedBusTest : public testing::Test {
 protected:
  void end(TransferResult result = TransferResult::kDone) {
    hardware_.running = false;
    bus_.complete(result);
  }
  FakeClock clock_;
  FakeHardware hardware_;
  SharedBus bus_{hardware_, clock_, milliseconds(5)};
  SharedPort baro_{bus_, 1};
  SharedPort memory_{bus_, 2};
  SharedPort imu_{bus_, 3, true};
  FakeOwner a_, b_, c_;
};

TEST_F(SharedBusTest, TransfersRunOneAtATimeInTheirOrder) {
  ASSERT_TRUE(baro_.start(a_.transfer));
  ASSERT_TRUE(memory_.start(b_.transfer));
  EXPECT_EQ(hardware_.devices, (std::vector<std::uint8_t>{1}));
  clock_.time = microseconds(40);
  end();
  EXPECT_EQ(hardware_.devices, (std::vector<std::uint8_t>{1, 2}));
  EXPECT_EQ(a_.results, std::vector{TransferResult::kDone});
  EXPECT_EQ(a_.ends, std::vector{microseconds(40)});
  EXPECT_TRUE(b_.results.empty());
  end();
  EXPECT_TRUE(bus_.idle());
  EXPECT_EQ(bus_.failures(), 0u);
}

TEST_F(SharedBusTest, AnUrgentPortGoesBeforeOthersThatWait) {
  ASSERT_TRUE(baro_.start(a_.transfer));
  ASSERT_TRUE(memory_.start(b_.transfer));
  ASSERT_TRUE(imu_.start(c_.transfer));
  end();
  end();
  EXPECT_EQ(hardware_.devices, (std::vector<std::uint8_t>{1, 3, 2}));
}

TEST_F(SharedBusTest, AChainOfUrgentTransfersIsNotTornApart) {
  c_.port = &imu_;
  c_.again = 1;
  ASSERT_TRUE(imu_.start(c_.transfer));
  ASSERT_TRUE(baro_.start(a_.transfer));
  end();
  end();
  EXPECT_EQ(hardware_.devices, (std::vector<std::uint8_t>{3, 3, 1}));
}

TEST_F(SharedBusTest, WhatHangsIsAbortedAndTheOthersFollow) {
  ASSERT_TRUE(baro_.start(a_.transfer));
  ASSERT_TRUE(memory_.start(b_.transfer));
  clock_.time = microseconds(4999);
  bus_.step();
  EXPECT_EQ(hardware_.aborts, 0);
  clock_.time = microseconds(5000);
  bus_.step();
  EXPECT_EQ(hardware_.aborts, 1);
  EXPECT_EQ(a_.results, std::vector{TransferResult::kTimeout});
  EXPECT_EQ(hardware_.devices, (std::vector<std::uint8_t>{1, 2}));
  EXPECT_EQ(bus_.failures(), 1u);
  // The one that follows has the whole time for itself.
  clock_.time = microseconds(9999);
  bus_.step();
  EXPECT_EQ(hardware_.aborts, 1);
}

TEST_F(SharedBusTest, AFailureIsReportedAndCounted) {
  ASSERT_TRUE(baro_.start(a_.transfer));
  end(TransferResult::kNoAnswer);
  EXPECT_EQ(a_.results, std::vector{TransferResult::kNoAnswer});
  EXPECT_EQ(bus_.failures(), 1u);
}

TEST_F(SharedBusTest, AnEndWithoutATransferChangesNothing) {
  bus_.complete(TransferResult::kDone);
  bus_.step();
  EXPECT_TRUE(bus_.idle());
  EXPECT_EQ(hardware_.aborts, 0);
}

TEST_F(SharedBusTest, RefusesWhatCannotBeATransfer) {
  std::array<std::uint8_t, kMaxTransferBytes> in{};
  for (const Transfer& bad :
       {Transfer{}, Transfer{&a_.byte, 0, in.data(), 0, &a_},
        Transfer{&a_.byte, 1, in.data(), kMaxTransferBytes, &a_},
        Transfer{nullptr, 1, in.data(), 1, &a_}, Transfer{&a_.byte, 1, nullptr, 1, &a_},
        Transfer{&a_.byte, 1, in.data(), 1, nullptr},
        Transfer{&a_.byte, 2, in.data(), SIZE_MAX, &a_}}) {
    Transfer transfer = bad;
    EXPECT_FALSE(baro_.start(transfer));
  }
  EXPECT_TRUE(hardware_.devices.empty());
  FakeOwner d;
  Transfer longest{&d.byte, 1, in.data(), kMaxTransferBytes - 1, &d};
  EXPECT_TRUE(baro_.start(longest));
}

TEST_F(SharedBusTest, RefusesMoreThanItHolds) {
  for (std::size_t k = 0; k < SharedBus::kSlots + 1; ++k)
    EXPECT_TRUE(baro_.start(a_.transfer)) << k;
  EXPECT_FALSE(baro_.start(a_.transfer));
  for (std::size_t k = 0; k < SharedBus::kSlots + 1; ++k) end();
  EXPECT_EQ(a_.results.size(), SharedBus::kSlots + 1);
  EXPECT_TRUE(baro_.start(a_.transfer));
}

TEST_F(SharedBusTest, EveryTransferEndsOnceWhateverHappens) {
  std::mt19937 random(1);
  std::array<FakeOwner*, 3> owners{&a_, &b_, &c_};
  std::array<Port*, 3> ports{&baro_, &memory_, &imu_};
  std::array<std::size_t, 3> started{};
  for (int k = 0; k < 20'000; ++k) {
    clock_.time += microseconds(500);
    const auto who = static_cast<std::size_t>(random() % 3);
    switch (random() % 4) {
      case 0:
      case 1:
        started[who] += ports[who]->start(owners[who]->transfer) ? 1u : 0u;
        break;
      case 2:
        if (hardware_.running) end(static_cast<TransferResult>(random() % 3));
        break;
      default:
        bus_.step();
    }
  }
  while (!bus_.idle()) end();
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(owners[k]->results.size(), started[k]);
  EXPECT_EQ(hardware_.masked, 0);
  EXPECT_GT(hardware_.aborts, 10);
}

}  // namespace
}  // namespace rosflight::boards::parts
