// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>
#include <cstring>
#include <string>
#include <vector>
#include "firmware/boards/simulated/simulated_board.hpp"
#include "firmware/core/checksum.hpp"
#include "firmware/core/parameter_store.hpp"

/// Slots as some firmware could have written them, and what a load made of them.
namespace rosflight::core {

using boards::SimulatedStorage;

inline constexpr std::size_t kHeader = 12;
inline constexpr auto kFloatCode = static_cast<std::uint8_t>(ParamType::kFloat);

inline void put_u32(std::vector<std::uint8_t>& out, std::uint32_t v) {
  for (int k = 0; k < 4; ++k) out.push_back(static_cast<std::uint8_t>(v >> (8 * k)));
}

struct Entry {
  std::string name;
  std::uint8_t type;
  std::uint32_t bits;
};

/// A slot as some other firmware could have written it.
inline std::vector<std::uint8_t> slot_of(std::uint32_t sequence,
                                         const std::vector<Entry>& entries) {
  std::vector<std::uint8_t> out;
  put_u32(out, 0x31504652u);
  put_u32(out, sequence);
  put_u32(out, static_cast<std::uint32_t>(entries.size()));
  for (const Entry& e : entries) {
    const link::ParamName name = padded_name(e.name.c_str());
    out.insert(out.end(), name.begin(), name.end());
    out.push_back(e.type);
    put_u32(out, e.bits);
  }
  Crc32 crc;
  crc.add(out.data(), out.size());
  put_u32(out, crc.value());
  return out;
}

inline void place(SimulatedStorage& storage, int slot, const std::vector<std::uint8_t>& bytes) {
  std::vector<std::uint8_t> all = storage.bytes();
  const std::size_t start = slot == 0 ? 0 : all.size() / 2;
  std::copy(bytes.begin(), bytes.end(), all.begin() + static_cast<std::ptrdiff_t>(start));
  storage.set_bytes(std::move(all));
}

inline std::uint32_t float_bits(float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

inline bool same(const Parameters& a, const Parameters& b) {
  for (std::size_t k = 0; k < kParamCount; ++k) {
    if (a.bits(static_cast<Param>(k)) != b.bits(static_cast<Param>(k))) return false;
  }
  return true;
}

/// A set that differs from another number's in many places.
inline Parameters set_number(int n) {
  Parameters p;
  static_cast<void>(p.set_int(Param::kSysId, n));
  for (std::size_t k = 0; k < 100; ++k) {
    const auto id = static_cast<Param>(static_cast<std::size_t>(Param::kPriMixer0_0) + k);
    static_cast<void>(p.set_float(id, static_cast<float>(n) + static_cast<float>(k) * 0.01f));
  }
  static_cast<void>(p.set_float(Param::kBattVoltLpf, 0.5f + 0.001f * static_cast<float>(n)));
  return p;
}

struct Loaded {
  StoreResult result;
  Parameters parameters;
  ParameterStore::LoadReport report;
};

inline Loaded load(hal::Storage& storage) {
  Loaded l{};
  l.result = ParameterStore(storage).load(l.parameters, l.report);
  return l;
}

}  // namespace rosflight::core
