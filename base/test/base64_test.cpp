// SPDX-License-Identifier: BSD-3-Clause
#include "base/base64.hpp"

#include <gtest/gtest.h>

#include <array>
#include <utility>

namespace rosflight::base {
namespace {

/// RFC 4648, section 10.
TEST(Base64, VectorsOfTheStandard) {
  const std::array<std::pair<const char*, const char*>, 7> vectors{{{"", ""},
                                                                    {"f", "Zg=="},
                                                                    {"fo", "Zm8="},
                                                                    {"foo", "Zm9v"},
                                                                    {"foob", "Zm9vYg=="},
                                                                    {"fooba", "Zm9vYmE="},
                                                                    {"foobar", "Zm9vYmFy"}}};
  for (const auto& [bytes, text] : vectors) EXPECT_EQ(base64(bytes), text);
}

TEST(Base64, BytesAbove127HaveNoSign) {
  EXPECT_EQ(base64("\xff\xff\xff"), "////");
  EXPECT_EQ(base64("\xfb\xef\xbe"), "++++");
}

}  // namespace
}  // namespace rosflight::base
