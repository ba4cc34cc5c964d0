// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/setup.hpp"

namespace rosflight::boards::parts {

bool Setup::begin(Start how, Time now) {
  if (on_bus_) return false;
  how_ = how;
  at_ = 0;
  rewritten_ = 0;
  attempts_ = 0;
  wrote_ = false;
  not_before_ = now;
  limit_ = now;
  status_ = Status::kBusy;
  result_ = TransferResult::kDone;
  proceed(now);
  return true;
}

void Setup::step(Time now) {
  if (status_ == Status::kBusy && !on_bus_ && now >= not_before_) proceed(now);
}

/// Starts the transfer that the current row asks for next. A port that is full is asked again at the
/// next step.
void Setup::proceed(Time now) {
  while (at_ < count_ && steps_[at_].kind == SetupKind::kWrite && how_ == Start::kWarm &&
         !steps_[at_].even_if_warm) {
    ++at_;
  }
  if (at_ == count_) {
    status_ = Status::kDone;
    return;
  }
  const SetupStep& row = steps_[at_];
  if (row.kind == SetupKind::kAwait && attempts_ == 0) {
    limit_ = now + Time{row.wait_us};
    attempts_ = 1;
  }
  const bool read_first = how_ == Start::kWarm && attempts_ == 0;
  const bool write = row.kind == SetupKind::kWrite ||
                     (row.kind == SetupKind::kConfigure && !wrote_ && !read_first);
  on_bus_ = write ? start_write() : start_read();
}

bool Setup::start_write() {
  reading_ = false;
  out_ = {steps_[at_].reg, steps_[at_].value};
  transfer_ = {out_.data(), 2, nullptr, 0, this};
  return port_.start(transfer_);
}

bool Setup::start_read() {
  reading_ = true;
  out_ = {static_cast<std::uint8_t>(steps_[at_].reg | dialect_.read_flag), 0};
  transfer_ = {out_.data(), 1u + dialect_.dummy_bytes, &found_, 1, this};
  return port_.start(transfer_);
}

void Setup::transfer_done(Transfer& /*transfer*/, TransferResult result, Time end) {
  on_bus_ = false;
  const SetupStep& row = steps_[at_];
  // A part that resets itself may not acknowledge the command; a void read may fail.
  const bool may_fail = row.kind == SetupKind::kVoid || row.kind == SetupKind::kWrite;
  if (result != TransferResult::kDone && (!may_fail || result != TransferResult::kNoAnswer)) {
    fail(result);
    return;
  }
  if (reading_) {
    compare(end);
  } else if (row.kind == SetupKind::kWrite) {
    next(end, row.wait_us);
  } else {
    wrote_ = true;
    ++attempts_;
    not_before_ = end + Time{row.wait_us};
  }
  if (status_ == Status::kBusy && end >= not_before_) proceed(end);
}

void Setup::next(Time now, std::uint32_t wait_us) {
  ++at_;
  attempts_ = 0;
  wrote_ = false;
  not_before_ = now + Time{wait_us};
}

void Setup::compare(Time now) {
  const SetupStep& row = steps_[at_];
  const bool equal = ((found_ ^ row.value) & row.mask) == 0;
  if (equal || row.kind == SetupKind::kVoid) {
    next(now, 0);
  } else {
    mismatch(now);
  }
}

void Setup::mismatch(Time now) {
  const SetupStep& row = steps_[at_];
  if (row.kind == SetupKind::kAwait && now < limit_) {
    not_before_ = now + Time{1};  // at the next step
  } else if (row.kind == SetupKind::kConfigure && attempts_ < kAttempts) {
    if (attempts_ == 0) ++rewritten_;  // a warm start read it
    attempts_ = attempts_ == 0 ? 1 : attempts_;
    wrote_ = false;
  } else {
    fail(TransferResult::kDone);
  }
}

void Setup::fail(TransferResult result) {
  result_ = result;
  status_ = Status::kFailed;
}

void Setup::describe(Text& text) const {
  if (status_ != Status::kFailed) return;
  const SetupStep& row = steps_[at_];
  switch (result_) {
    case TransferResult::kNoAnswer:
      text.add("no answer");
      return;
    case TransferResult::kBusFault:
      text.add("bus fault");
      return;
    case TransferResult::kTimeout:
      text.add("bus stuck");
      return;
    case TransferResult::kDone:
      break;
  }
  if (row.kind == SetupKind::kIdentity) {
    text.add("identity ").hex(found_).add(", expected ").hex(row.value);
  } else if (row.kind == SetupKind::kAwait) {
    text.add("not ready, register ").hex(row.reg).add(" is ").hex(found_);
  } else {
    text.add("register ").hex(row.reg).add(" is ").hex(found_).add(", written ").hex(row.value);
  }
}

}  // namespace rosflight::boards::parts
