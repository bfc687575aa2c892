// SPDX-License-Identifier: Apache-2.0
#include "framework/core/portable.h"

#include <gnu/libc-version.h>
#include <sys/auxv.h>
#include <sys/utsname.h>

#include <cmath>
#include <cstdlib>
#include <cstring>

#include "framework/core/checksum.h"

namespace lapwing {

namespace {

constexpr const char* kPortableMark = "LAPWING_PORTABLE";
constexpr const char* kTunables = "GLIBC_TUNABLES";
constexpr const char* kSlower = "glibc.cpu.hwcaps=-FMA,-AVX2,-FMA4";

// Bits of the functions' results, over the arguments that programs have and a few that are large.
std::string behaviour_of_functions() {
  std::string bits;
  const auto keep = [&](double value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    bits.append(bytes, sizeof value);
  };
  const auto keep_single = [&](float value) { keep(value); };
  // Volatile, so that the compiler calls the functions.
  for (int i = 0; i < 2000; ++i) {
    volatile double x = 1e-3 + 0.01171875 * i * (i % 7 == 0 ? 1e4 : 1.0);
    volatile double y = 0.37 + 0.0137 * ((i * 7919) % 2000);
    volatile float s = static_cast<float>(x);
    for (double (*function)(double) :
         {static_cast<double (*)(double)>(std::sin), static_cast<double (*)(double)>(std::cos),
          static_cast<double (*)(double)>(std::tan), static_cast<double (*)(double)>(std::atan),
          static_cast<double (*)(double)>(std::log), static_cast<double (*)(double)>(std::log2),
          static_cast<double (*)(double)>(std::cbrt), static_cast<double (*)(double)>(std::sqrt)})
      keep(function(x));
    for (double (*function)(double) :
         {static_cast<double (*)(double)>(std::exp), static_cast<double (*)(double)>(std::exp2),
          static_cast<double (*)(double)>(std::sinh), static_cast<double (*)(double)>(std::tanh),
          static_cast<double (*)(double)>(std::expm1), static_cast<double (*)(double)>(std::erf)})
      keep(function(y - 10));
    keep(std::asin(y / 30));
    keep(std::acos(y / 30));
    keep(std::pow(x, y / 10));
    keep(std::atan2(y - 5, x));
    keep(std::hypot(x, y));
    keep(std::fma(x, y, -x * y));
    for (float (*function)(float) :
         {static_cast<float (*)(float)>(std::sin), static_cast<float (*)(float)>(std::cos),
          static_cast<float (*)(float)>(std::log)})
      keep_single(function(s));
    keep_single(std::exp(s / 1e4F));
    keep_single(std::pow(s, 0.7F));
  }
  return sha256(bits).substr(0, 12);
}

std::string instruction_sets() {
  std::string text;
#if defined(__x86_64__)
  __builtin_cpu_init();
  const auto add = [&](bool has, const char* name) {
    if (has) text += std::string(" ") + name;
  };
  add(__builtin_cpu_supports("sse4.2"), "sse4.2");
  add(__builtin_cpu_supports("avx"), "avx");
  add(__builtin_cpu_supports("fma"), "fma");
  add(__builtin_cpu_supports("fma4"), "fma4");
  add(__builtin_cpu_supports("avx2"), "avx2");
  add(__builtin_cpu_supports("avx512f"), "avx512f");
  add(__builtin_cpu_supports("avx512dq"), "avx512dq");
  add(__builtin_cpu_supports("avx512bw"), "avx512bw");
  add(__builtin_cpu_supports("avx512vl"), "avx512vl");
  add(__builtin_cpu_supports("avx512vnni"), "avx512vnni");
  if (text.empty()) text = " none beyond x86-64";
#else
  char number[32];
  std::snprintf(number, sizeof number, " %lx", ::getauxval(AT_HWCAP));
  text = number;
#endif
  return text.substr(1);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> portable_environment() {
  const char* given = std::getenv(kTunables);
  std::string tunables = given ? given : "";
  if (tunables.find(kSlower) == std::string::npos)
    tunables += (tunables.empty() ? "" : ":") + std::string(kSlower);
  return {{kPortableMark, "1"},
          {kTunables, tunables},
          {"OPENBLAS_CORETYPE", "PRESCOTT"},
          {"ONEDNN_MAX_CPU_ISA", "SSE41"},
          {"DNNL_MAX_CPU_ISA", "SSE41"},
          {"OPENCV_CPU_DISABLE", "SSE4.2,AVX,FP16,AVX2,FMA3,AVX512-SKX"}};
}

bool is_portable() {
  static const bool portable = [] {
    for (const auto& [name, value] : portable_environment()) {
      const char* there = std::getenv(name.c_str());
      if (!there || value != there) return false;
    }
    return true;
  }();
  return portable;
}

const std::string& machine_of_numbers() {
  static const std::string text = [] {
    struct utsname system {};
    ::uname(&system);
    const std::string library = std::string("glibc ") + gnu_get_libc_version() + " (functions " +
                                behaviour_of_functions() + ")";
    return std::string(system.machine) + ", " + library + ", " +
           (is_portable() ? "portable" : instruction_sets());
  }();
  return text;
}

}  // namespace lapwing
