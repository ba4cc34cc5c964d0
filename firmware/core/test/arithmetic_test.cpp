// SPDX-License-Identifier: BSD-3-Clause
// On the host; the boards' own tests include the same header.
#include "firmware/core/test/arithmetic_contract.hpp"
