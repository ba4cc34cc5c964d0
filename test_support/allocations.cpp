// SPDX-License-Identifier: BSD-3-Clause
// Alone in its file: a compiler that sees both ends of an allocation takes the pair for a mistake.
#include "test_support/allocations.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> g_count{0};  // NOLINT: operator new has no other place to count in

void* take(std::size_t size, std::size_t alignment) {
  ++g_count;
  // aligned_alloc takes whole multiples of the alignment.
  void* memory = alignment == 0 ? std::malloc(size == 0 ? 1 : size)
                                : std::aligned_alloc(
                                      alignment, (size + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

namespace rosflight::test_support {

std::size_t allocations() {
  return g_count;
}

}  // namespace rosflight::test_support

void* operator new(std::size_t size) {
  return take(size, 0);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return take(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t /*size*/) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t /*alignment*/) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t /*size*/, std::align_val_t /*alignment*/) noexcept {
  std::free(memory);
}
