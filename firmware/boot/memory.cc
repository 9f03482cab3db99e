// SPDX-License-Identifier: Apache-2.0
// The functions of <cstring> that the runtime and the compiler call. There is no C library to bring them.
#include <cstddef>
#include <cstdint>

extern "C" {

void* memcpy(void* to, const void* from, std::size_t size) {
  auto* t = static_cast<unsigned char*>(to);
  const auto* f = static_cast<const unsigned char*>(from);
  if (((reinterpret_cast<std::uintptr_t>(t) | reinterpret_cast<std::uintptr_t>(f)) & 3) == 0) {
    for (; size >= 4; size -= 4, t += 4, f += 4) {
      using Word [[gnu::may_alias]] = std::uint32_t;
      *reinterpret_cast<Word*>(t) = *reinterpret_cast<const Word*>(f);
    }
  }
  for (; size != 0; --size) *t++ = *f++;
  return to;
}

void* memset(void* to, int value, std::size_t size) {
  auto* t = static_cast<unsigned char*>(to);
  const auto byte = static_cast<unsigned char>(value);
  for (; size != 0 && (reinterpret_cast<std::uintptr_t>(t) & 3) != 0; --size) *t++ = byte;
  for (; size >= 4; size -= 4, t += 4) {
    using Word [[gnu::may_alias]] = std::uint32_t;
    *reinterpret_cast<Word*>(t) = byte * 0x0101'0101u;
  }
  for (; size != 0; --size) *t++ = byte;
  return to;
}

void* memmove(void* to, const void* from, std::size_t size) {
  auto* t = static_cast<unsigned char*>(to);
  const auto* f = static_cast<const unsigned char*>(from);
  if (t <= f || t >= f + size) return memcpy(to, from, size);
  while (size-- != 0) t[size] = f[size];
  return to;
}

int memcmp(const void* a, const void* b, std::size_t size) {
  const auto* x = static_cast<const unsigned char*>(a);
  const auto* y = static_cast<const unsigned char*>(b);
  for (; size != 0; --size, ++x, ++y)
    if (*x != *y) return *x - *y;
  return 0;
}

std::size_t strlen(const char* text) {
  std::size_t size = 0;
  while (text[size] != '\0') ++size;
  return size;
}

int strcmp(const char* a, const char* b) {
  for (; *a != '\0' && *a == *b; ++a, ++b) {
  }
  return static_cast<unsigned char>(*a) - static_cast<unsigned char>(*b);
}

char* strcpy(char* to, const char* from) {
  memcpy(to, from, strlen(from) + 1);
  return to;
}

char* strncpy(char* to, const char* from, std::size_t size) {
  std::size_t i = 0;
  for (; i < size && from[i] != '\0'; ++i) to[i] = from[i];
  for (; i < size; ++i) to[i] = '\0';
  return to;
}

}  // extern "C"
