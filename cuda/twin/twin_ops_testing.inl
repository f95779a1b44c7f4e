// SPDX-License-Identifier: Apache-2.0
// Runs the kernels of generator/semantics*.ptx on special values, and compares each slot of their results with the
// expected value and with the slot from a device. Included after the kernels, in the namespace of the operations.
template <class Real>
using Limits = std::numeric_limits<Real>;

// The operands: zeros, subnormals, neighbours of 1 and of powers of two, halves, limits of integers, the largest
// number, infinity, NaN, and factors whose product or quotient is just below the least normal number.
template <class Real>
std::vector<Real> special_values() {
  const Real tiny = Limits<Real>::denorm_min(), least = Limits<Real>::min(), most = Limits<Real>::max(), one = 1,
             epsilon = Limits<Real>::epsilon();
  std::vector<Real> values = {0,
                              tiny,
                              least - tiny,
                              least,
                              2 * least,
                              Real(0.3),
                              Real(0.5),
                              one - epsilon / 2,
                              1,
                              1 + epsilon,
                              Real(1.5),
                              Real(2.5),
                              Real(2147483648.0),
                              Real(4294967296.0),
                              Real(9.3e18),
                              Real(2e19),
                              1 / least,
                              most,
                              Limits<Real>::infinity()};
  if (sizeof(Real) == 8) {  // values that round to the least normal float, and values slightly too small for it
    for (double x : {0x1p-126 - 0x1p-151, 0x1p-126 - 0x1p-150, 0x1p-126 - 0x1p-170, 0x1p-126, 0x1p-140}) {
      values.push_back(static_cast<Real>(x));
    }
    values.push_back(static_cast<Real>(std::nextafter(0x1p-126 - 0x1p-151, 0.0)));
  }
  for (std::size_t i = 0, n = values.size(); i < n; ++i) values.push_back(-values[i]);
  values.push_back(Limits<Real>::quiet_NaN());
  return values;
}

// Whether the slot's bytes, as type T, are those of the expected value. All NaNs are equal.
template <class T>
bool same(std::uint64_t slot, T expected) {
  T found;
  std::memcpy(&found, &slot, sizeof found);
  if constexpr (std::is_floating_point_v<T>) {
    if (std::isnan(found) || std::isnan(expected)) return std::isnan(found) && std::isnan(expected);
  }
  return std::bit_cast<Bits<T>>(found) == std::bit_cast<Bits<T>>(expected);
}

// One slot of a kernel, and its expected value for (a, b, c).
template <class In>
struct Slot {
  std::string name;
  std::function<bool(std::uint64_t slot, In a, In b, In c)> holds;
};

template <class In, class Expected>
Slot<In> slot(const std::string& name, Expected expected) {
  return {name, [expected](std::uint64_t found, In a, In b, In c) { return same(found, expected(a, b, c)); }};
}

template <class In>
struct alignas(16) Input {
  In values[3];
};

template <class In>
std::vector<Input<In>> triples(const std::vector<In>& values) {
  std::vector<Input<In>> all;
  for (In a : values) {
    for (In b : values) {
      for (In c : values) all.push_back({{a, b, c}});
    }
  }
  return all;
}

template <class Kernel, class In>
std::vector<std::uint64_t> run_here(const std::vector<Input<In>>& inputs, std::size_t slots) {
  std::vector<std::uint64_t> out(inputs.size() * slots);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const void *in_at = &inputs[i], *out_at = out.data() + i * slots;
    const unsigned char* const parameters[] = {reinterpret_cast<const unsigned char*>(&in_at),
                                               reinterpret_cast<const unsigned char*>(&out_at)};
    Kernel::run(parameters, AllFused{});
  }
  return out;
}

template <class Kernel, class In>
void check(const std::vector<Slot<In>>& slots, const std::vector<In>& values) {
  const std::vector<Input<In>> inputs = triples(values);
  const std::vector<std::uint64_t> out = run_here<Kernel>(inputs, slots.size());
  std::vector<int> wrong(slots.size(), 0);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const auto& [a, b, c] = inputs[i].values;
    for (std::size_t s = 0; s < slots.size(); ++s) {
      if (!slots[s].holds(out[i * slots.size() + s], a, b, c) && wrong[s]++ == 0) {
        ADD_FAILURE() << slots[s].name << " of " << a << ", " << b << ", " << c;
      }
    }
  }
}

#ifdef GRAZE_HAS_NVCC
// Whether both slots are NaN, as doubles, or as floats if their upper halves are zero.
bool both_nan(std::uint64_t a, std::uint64_t b) {
  if (is_nan(std::bit_cast<f64>(a)) && is_nan(std::bit_cast<f64>(b))) return true;
  return a >> 32 == 0 && b >> 32 == 0 && is_nan(std::bit_cast<f32>(static_cast<u32>(a))) &&
         is_nan(std::bit_cast<f32>(static_cast<u32>(b)));
}
#endif

// Runs the same kernel on a device, and compares the results slot by slot.
template <class Kernel, class In>
void check_on_device(const std::string& ptx_file, const std::vector<Slot<In>>& slots, const std::vector<In>& values) {
#ifdef GRAZE_HAS_NVCC
  if (std::string why; !open_device(why)) GTEST_SKIP() << why;
  std::ifstream file(GRAZE_SOURCE_DIR "/cuda/twin/generator/" + ptx_file);
  const std::string ptx{std::istreambuf_iterator<char>(file), {}};
  const std::vector<Input<In>> inputs = triples(values);
  const std::vector<std::uint64_t> here = run_here<Kernel>(inputs, slots.size());
  const std::vector<std::uint64_t> there =
      run_ptx(ptx, std::string(Kernel::kName), inputs.data(), inputs.size(), sizeof inputs[0], slots.size());
  std::vector<int> wrong(slots.size(), 0);
  for (std::size_t i = 0; i < here.size(); ++i) {
    const std::size_t s = i % slots.size();
    if (here[i] != there[i] && !both_nan(here[i], there[i]) && wrong[s]++ == 0) {
      const auto& [a, b, c] = inputs[i / slots.size()].values;
      ADD_FAILURE() << slots[s].name << " of " << a << ", " << b << ", " << c << ": twin " << std::hex << here[i]
                    << ", device " << there[i];
    }
  }
#else
  static_cast<void>(ptx_file);
  static_cast<void>(slots);
  static_cast<void>(values);
  GTEST_SKIP() << "built without CUDA";
#endif
}

template <class In>
std::vector<Slot<In>> joined(std::vector<std::vector<Slot<In>>> parts) {
  std::vector<Slot<In>> all;
  for (auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}
