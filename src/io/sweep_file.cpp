#include "cloudbow/io/sweep_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/file_library_lock.hpp"
#include "cloudbow/core/sandbox.hpp"
#include "io/netcdf4_file.hpp"
#include "io/stored_result.hpp"

namespace cloudbow {
namespace {

using hdf5::Handle;
using netcdf4::Attribute;
using netcdf4::AttributeValue;
using netcdf4::BlockVariable;

const Stored* find(const StoredGroup& group, const std::string& name) {
  const auto found = std::find_if(group.variables.begin(), group.variables.end(),
                                  [&name](const Stored& variable) { return variable.name == name; });
  return found == group.variables.end() ? nullptr : &*found;
}

const AttributeValue* find(const std::vector<Attribute>& attributes, const std::string& name) {
  const auto found = std::find_if(attributes.begin(), attributes.end(),
                                  [&name](const Attribute& attribute) { return attribute.name == name; });
  return found == attributes.end() ? nullptr : &found->value;
}

/// One attribute in all runs; null: a run has none.
using OfRuns = std::vector<const AttributeValue*>;

bool all_same(const OfRuns& values) {
  const AttributeValue* first = nullptr;
  for (const AttributeValue* value : values) {
    if (value == nullptr) continue;
    if (first == nullptr) first = value;
    if (*value != *first) return false;
  }
  return true;
}

bool is_text(const AttributeValue& value) { return std::holds_alternative<std::string>(value); }

template <class Value>
constexpr bool is_list = requires {
  typename Value::value_type;
}
&&!std::is_same_v<Value, std::string>;

/// Length of a list of numbers; none: it is one number or a text.
std::optional<std::size_t> length_of(const AttributeValue& value) {
  return std::visit(
      [](const auto& numbers) -> std::optional<std::size_t> {
        if constexpr (is_list<std::decay_t<decltype(numbers)>>) return numbers.size();
        return std::nullopt;
      },
      value);
}

/// Whether two variables of one name can be joined: coordinates have the same values, others the same shape. Attributes
/// of one name hold values of one kind.
bool are_alike(const Stored& a, const Stored& b) {
  if (a.is_coordinate != b.is_coordinate || a.is_length != b.is_length || a.shape != b.shape || a.type != b.type ||
      a.dimensions != b.dimensions || (a.is_coordinate && a.contents != b.contents))
    return false;
  return std::all_of(a.attributes.begin(), a.attributes.end(), [&b](const Attribute& attribute) {
    const AttributeValue* other = find(b.attributes, attribute.name);
    return other == nullptr || other->index() == attribute.value.index();
  });
}

std::string with_spaces(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

class SweepWriter {
 public:
  SweepWriter(const std::filesystem::path& target, std::span<const SweepDimension> dimensions,
              std::span<const SweptRun> runs, const SweepInfo& info)
      : target_(target), dimensions_(dimensions), runs_(runs), info_(info) {
    for (const SweepDimension& dimension : dimensions) swept_.push_back(dimension.name);
    for (const SweptRun& run : runs) {
      if (run.result.empty()) {
        results_.emplace_back();
        continue;
      }
      const Handle file = hdf5::open_file(run.result);
      if (title_.empty()) title_ = hdf5::attribute_text(file, "title");
      results_.push_back(read_groups(file));
    }
    join_groups();
  }

  void write(const std::filesystem::path& path) {
    Handle file = hdf5::create_file(path);
    netcdf4::write_attributes(file, {{"Conventions", "CF-1.10"},
                                     {"title", title_},
                                     {"source", info_.source},
                                     {"history", info_.history},
                                     {"scene", info_.scene}});
    for (const StoredGroup& group : joined_) {
      if (group.name.empty()) {
        write_group(file, group);
      } else {
        Handle into = netcdf4::create_group(file, group.name.c_str());
        write_group(into, group);
        into.close();
      }
    }
    write_runs(file);
    for (std::size_t n = 0; n < runs_.size(); ++n) {
      if (!runs_[n].result.empty()) copy_values(n);
    }
    for (Open& open : open_) open.variable.close();
    open_.clear();
    hdf5::finish_file(file);
  }

 private:
  /// All groups and variables of the results, each as in the first result that has it.
  void join_groups() {
    for (const std::vector<StoredGroup>& groups : results_) {
      for (const StoredGroup& group : groups) {
        const auto known = std::find_if(joined_.begin(), joined_.end(),
                                        [&group](const StoredGroup& other) { return other.name == group.name; });
        if (known == joined_.end()) {
          joined_.push_back(group);
          continue;
        }
        for (const Stored& variable : group.variables) {
          const Stored* other = find(*known, variable.name);
          if (other == nullptr) {
            known->variables.push_back(variable);
          } else if (!are_alike(variable, *other)) {
            fail_different(group, variable.name);
          }
        }
        for (const Attribute& attribute : group.attributes) {
          const AttributeValue* other = find(known->attributes, attribute.name);
          if (other == nullptr) {
            known->attributes.push_back(attribute);
          } else if (other->index() != attribute.value.index()) {
            fail_different(group, attribute.name);
          }
        }
      }
    }
  }

  [[noreturn]] void fail_different(const StoredGroup& group, const std::string& name) const {
    throw InputError(fmt::format(
        "{}: runs of the sweep do not have the same {}/{} (found two of them, allowed one, which is stored once); the "
        "results of the single runs are in {}",
        target_.string(), group.name.empty() ? "" : "/" + group.name, name, first_result().parent_path().string()));
  }

  const std::filesystem::path& first_result() const {
    return std::find_if(runs_.begin(), runs_.end(), [](const SweptRun& run) { return !run.result.empty(); })->result;
  }

  const StoredGroup* group_of(std::size_t run, const std::string& name) const {
    for (const StoredGroup& group : results_[run]) {
      if (group.name == name) return &group;
    }
    return nullptr;
  }

  const Stored* stored_of(std::size_t run, const std::string& group, const std::string& name) const {
    const StoredGroup* of_run = group_of(run, group);
    return of_run == nullptr ? nullptr : find(*of_run, name);
  }

  std::vector<hsize_t> indices(std::size_t run) const {
    std::vector<hsize_t> index(dimensions_.size());
    for (std::size_t axis = dimensions_.size(); axis-- > 0;) {
      index[axis] = run % dimensions_[axis].size();
      run /= dimensions_[axis].size();
    }
    return index;
  }

  void write_swept(hid_t group) const {
    for (const SweepDimension& dimension : dimensions_) {
      std::vector<Attribute> attributes{{"long_name", fmt::format("{} of the scene", dimension.key)},
                                        {"key", dimension.key}};
      if (!dimension.texts.empty()) {
        netcdf4::write_coordinate(group, dimension.name.c_str(), std::span<const std::string>(dimension.texts),
                                  attributes);
        continue;
      }
      attributes.insert(attributes.begin(), {"units", dimension.units});
      netcdf4::write_coordinate(group, dimension.name.c_str(), std::span<const double>(dimension.numbers), attributes);
    }
  }

  void write_group(hid_t into, const StoredGroup& group) {
    const std::vector<OfRuns> of_attribute = attributes_of_runs(group);
    for (std::size_t n = 0; n < group.attributes.size(); ++n) {
      if (is_text(group.attributes[n].value) && all_same(of_attribute[n]))
        netcdf4::write_attribute(into, group.attributes[n]);
    }
    write_swept(into);
    for (const Stored& variable : group.variables) write_stored(into, group, variable);
    const auto* const units = find(group.attributes, "units");
    for (std::size_t n = 0; n < group.attributes.size(); ++n) {
      const Attribute& attribute = group.attributes[n];
      if (is_text(attribute.value) && all_same(of_attribute[n])) continue;
      write_attribute_of_runs(into, group, attribute.name, of_attribute[n],
                              units != nullptr && is_text(*units) ? std::get<std::string>(*units) : "1");
    }
  }

  std::vector<OfRuns> attributes_of_runs(const StoredGroup& group) const {
    std::vector<OfRuns> of_attribute;
    for (const Attribute& attribute : group.attributes) {
      OfRuns values;
      for (std::size_t run = 0; run < runs_.size(); ++run) {
        const StoredGroup* of_run = group_of(run, group.name);
        values.push_back(of_run == nullptr ? nullptr : find(of_run->attributes, attribute.name));
      }
      of_attribute.push_back(std::move(values));
    }
    return of_attribute;
  }

  /// A coordinate with its values, or a variable whose values follow.
  void write_stored(hid_t into, const StoredGroup& group, const Stored& variable) {
    std::vector<Attribute> kept;
    std::vector<std::pair<std::string, OfRuns>> varied;
    for (const Attribute& attribute : variable.attributes) {
      OfRuns values;
      for (std::size_t run = 0; run < runs_.size(); ++run) {
        const Stored* of_run = stored_of(run, group.name, variable.name);
        values.push_back(of_run == nullptr ? nullptr : find(of_run->attributes, attribute.name));
      }
      if (all_same(values)) {
        kept.push_back(attribute);
      } else {
        varied.emplace_back(variable.name + "_" + attribute.name, std::move(values));
      }
    }
    if (variable.is_length) {
      netcdf4::write_dimension(into, variable.name.c_str(), variable.shape.front());
    } else if (variable.is_coordinate) {
      write_coordinate(into, group, variable, kept);
    } else if (variable.shape.empty()) {
      write_scalar(into, group, variable, kept);
    } else {
      const bool once = variable.is_mesh && same_contents(group, variable);
      std::vector<std::string> dimensions = once ? std::vector<std::string>() : swept_;
      dimensions.insert(dimensions.end(), variable.dimensions.begin(), variable.dimensions.end());
      open_.push_back(
          {group.name, variable.name, once,
           BlockVariable(into, variable.name.c_str(), dimensions, once ? 0 : swept_.size(), variable.type, kept)});
    }
    for (const auto& [name, values] : varied) write_attribute_of_runs(into, {}, name, values, "1");
  }

  bool same_contents(const StoredGroup& group, const Stored& variable) const {
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      const Stored* other = stored_of(run, group.name, variable.name);
      if (other != nullptr && other->contents != variable.contents) return false;
    }
    return true;
  }

  void write_coordinate(hid_t into, const StoredGroup& group, const Stored& variable,
                        const std::vector<Attribute>& attributes) const {
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      if (stored_of(run, group.name, variable.name) == nullptr) continue;
      const Handle file = hdf5::open_file(runs_[run].result);
      const std::string path = fmt::format("/{}/{}", group.name, variable.name);
      const std::vector<double> values = hdf5::read_all<double>(hdf5::open_dataset(file, path.c_str()));
      netcdf4::write_coordinate(into, variable.name.c_str(), std::span<const double>(values), attributes);
      return;
    }
  }

  /// Of a number in each run: with the dimensions along which it varies.
  void write_scalar(hid_t into, const StoredGroup& group, const Stored& variable,
                    const std::vector<Attribute>& attributes) const {
    std::vector<std::optional<double>> of_run;
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      const Stored* stored = stored_of(run, group.name, variable.name);
      of_run.push_back(stored == nullptr ? std::nullopt : std::optional(stored->scalar));
    }
    std::vector<std::size_t> axes;
    for (std::size_t axis = 0; axis < dimensions_.size(); ++axis) {
      if (varies_along(axis, of_run)) axes.push_back(axis);
    }
    if (axes.empty()) {
      netcdf4::write_scalar_coordinate(into, variable.name.c_str(), variable.scalar, attributes);
      return;
    }
    std::vector<std::string> names;
    std::size_t size = 1;
    for (const std::size_t axis : axes) {
      names.push_back(swept_[axis]);
      size *= dimensions_[axis].size();
    }
    std::vector<double> values(size, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      if (!of_run[run]) continue;
      std::size_t at = 0;
      for (const std::size_t axis : axes) at = at * dimensions_[axis].size() + indices(run)[axis];
      values[at] = *of_run[run];
    }
    netcdf4::write_variable(into, variable.name.c_str(), names, std::span<const double>(values), attributes);
  }

  bool varies_along(std::size_t axis, const std::vector<std::optional<double>>& of_run) const {
    std::map<std::vector<hsize_t>, double> first;
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      if (!of_run[run]) continue;
      std::vector<hsize_t> other = indices(run);
      other[axis] = 0;
      if (first.emplace(other, *of_run[run]).first->second != *of_run[run]) return true;
    }
    return false;
  }

  /// Numbers or texts that are attributes in single results.
  void write_attribute_of_runs(hid_t into, const StoredGroup& group, const std::string& attribute, const OfRuns& values,
                               const std::string& group_units) const {
    const bool taken = std::find(swept_.begin(), swept_.end(), attribute) != swept_.end();
    const std::string name = taken ? attribute + "_of_run" : attribute;
    std::string units = group_units;
    if (name.find("seconds") != std::string::npos) units = "s";
    if (name.ends_with("_bytes")) units = "byte";
    const std::vector<Attribute> attributes{{"units", units}, {"long_name", with_spaces(name)}};
    const AttributeValue& first =
        **std::find_if(values.begin(), values.end(), [](const AttributeValue* value) { return value != nullptr; });
    if (is_text(first)) {
      std::vector<std::string> texts;
      for (const AttributeValue* value : values) texts.push_back(value == nullptr ? "" : std::get<std::string>(*value));
      netcdf4::write_variable(into, name.c_str(), swept_, std::span<const std::string>(texts), {attributes[1]});
      return;
    }
    std::visit(
        [&](const auto& kind) {
          using Value = std::decay_t<decltype(kind)>;
          if constexpr (is_list<Value>) {
            write_lists<typename Value::value_type>(into, group, name, values, attributes);
          } else if constexpr (!std::is_same_v<Value, std::string>) {
            write_numbers<Value>(into, name, values, attributes);
          }
        },
        first);
  }

  /// The value of runs that have none.
  template <class Number>
  static Number missing() {
    if constexpr (std::is_floating_point_v<Number>) return std::numeric_limits<Number>::quiet_NaN();
    return std::numeric_limits<Number>::min();
  }

  template <class Number>
  static std::vector<Attribute> with_fill(std::vector<Attribute> attributes, bool needed) {
    if constexpr (std::is_integral_v<Number>) {
      if (needed) attributes.push_back({"_FillValue", missing<Number>()});
    }
    return attributes;
  }

  template <class Number>
  void write_numbers(hid_t into, const std::string& name, const OfRuns& values,
                     const std::vector<Attribute>& attributes) const {
    std::vector<Number> numbers;
    bool lacks = false;
    for (const AttributeValue* value : values) {
      lacks = lacks || value == nullptr;
      numbers.push_back(value == nullptr ? missing<Number>() : std::get<Number>(*value));
    }
    netcdf4::write_variable(into, name.c_str(), swept_, std::span<const Number>(numbers),
                            with_fill<Number>(attributes, lacks));
  }

  template <class Number>
  void write_lists(hid_t into, const StoredGroup& group, const std::string& name, const OfRuns& values,
                   const std::vector<Attribute>& attributes) const {
    std::size_t longest = 0, shortest = std::numeric_limits<std::size_t>::max();
    for (const AttributeValue* value : values) {
      const std::size_t length = value == nullptr ? 0 : length_of(*value).value_or(0);
      longest = std::max(longest, length);
      shortest = std::min(shortest, length);
    }
    const std::string dimension = list_dimension(into, group, name, longest);
    std::vector<Number> numbers;
    for (const AttributeValue* value : values) {
      std::vector<Number> list = value == nullptr ? std::vector<Number>() : std::get<std::vector<Number>>(*value);
      list.resize(longest, missing<Number>());
      numbers.insert(numbers.end(), list.begin(), list.end());
    }
    std::vector<std::string> dimensions = swept_;
    dimensions.push_back(dimension);
    netcdf4::write_variable(into, name.c_str(), dimensions, std::span<const Number>(numbers),
                            with_fill<Number>(attributes, shortest < longest));
  }

  /// The dimension of a list: `wavelength` in groups that have numbers for each, else one of its own.
  std::string list_dimension(hid_t into, const StoredGroup& group, const std::string& name, std::size_t length) const {
    const Stored* wavelength = find(joined_.front(), "wavelength");
    if (!group.name.empty() && wavelength != nullptr && wavelength->shape.front() == length) {
      if (!hdf5::exists(into, "wavelength"))
        write_coordinate(into, joined_.front(), *wavelength, wavelength->attributes);
      return "wavelength";
    }
    const std::string dimension = name + "_entry";
    netcdf4::write_dimension(into, dimension.c_str(), length);
    return dimension;
  }

  void write_runs(hid_t file) const {
    Handle group = netcdf4::create_group(file, "runs");
    write_swept(group);
    std::vector<std::string> scenes, messages;
    std::vector<std::int32_t> codes;
    for (const SweptRun& run : runs_) {
      scenes.push_back(run.scene);
      messages.push_back(run.message);
      codes.push_back(run.exit_code);
    }
    netcdf4::write_variable(
        group, "exit_code", swept_, std::span<const std::int32_t>(codes),
        {{"units", "1"}, {"long_name", "exit code of the run: 0 done, 3 not converged, 1 or 2 failed: no result"}});
    netcdf4::write_variable(group, "message", swept_, std::span<const std::string>(messages),
                            {{"long_name", "what went wrong in the run"}});
    netcdf4::write_variable(group, "scene", swept_, std::span<const std::string>(scenes),
                            {{"long_name", "the whole scene of the run (TOML)"}});
    group.close();
  }

  void copy_values(std::size_t run) {
    const Handle file = hdf5::open_file(runs_[run].result);
    const std::vector<hsize_t> at = indices(run);
    for (Open& open : open_) {
      if (stored_of(run, open.group, open.name) == nullptr || (open.once && open.written)) continue;
      const std::string path = fmt::format("/{}/{}", open.group, open.name);
      const std::vector<std::byte> values = values_of(hdf5::open_dataset(file, path.c_str()));
      open.variable.write(open.once ? std::vector<hsize_t>() : at, values);
      open.written = true;
    }
  }

  /// A variable whose values are being written.
  struct Open {
    std::string group, name;
    bool once;  ///< without the swept dimensions
    BlockVariable variable;
    bool written = false;
  };

  const std::filesystem::path target_;
  std::span<const SweepDimension> dimensions_;
  std::span<const SweptRun> runs_;
  const SweepInfo& info_;
  std::vector<std::string> swept_;  ///< names of the dimensions
  std::string title_;
  std::vector<std::vector<StoredGroup>> results_;  ///< of each run; empty: it failed
  std::vector<StoredGroup> joined_;
  std::vector<Open> open_;
};

/// One number or more.
std::vector<double> numbers_of_solves(hid_t group, const char* name) {
  std::vector<double> numbers = hdf5::attribute_numbers(group, name);
  if (numbers.empty()) throw hdf5::Error(fmt::format("attribute {} has no numbers", name));
  return numbers;
}

}  // namespace

void write_sweep(const std::filesystem::path& file, std::span<const SweepDimension> dimensions,
                 std::span<const SweptRun> runs, const SweepInfo& info) {
  assert(std::any_of(runs.begin(), runs.end(), [](const SweptRun& run) { return !run.result.empty(); }));
  const FileLibraryLock lock;
  AtomicFile target(file);
  try {
    SweepWriter(file, dimensions, runs, info).write(target.temporary());
  } catch (const hdf5::Error& error) {
    throw_unwritable(file, error.what());
  }
  target.commit();
}

bool is_whole_result(const std::filesystem::path& file, const std::string& run_key) {
  try {
    const FileLibraryLock lock;
    read_in_sandbox(file, {.library = "HDF5"}, [&file, &run_key] {
      const Handle open = hdf5::open_file(file);
      if (hdf5::attribute_text(open, "run_key") != run_key) throw hdf5::Error("it is the result of another run");
      for (const StoredGroup& group : read_groups(open)) {
        for (const Stored& variable : group.variables) {
          if (!variable.is_length)
            values_of(hdf5::open_dataset(open, fmt::format("/{}/{}", group.name, variable.name).c_str()));
        }
      }
    });
    return true;
  } catch (const InputError&) {
  } catch (const hdf5::Error&) {
  }
  return false;
}

std::string shortcoming_of_result(const std::filesystem::path& file) {
  const FileLibraryLock lock;
  try {
    const Handle open = hdf5::open_file(file);
    std::string sentence;
    for (const char* name : {"solver", "independent_columns"}) {
      if (!hdf5::exists(open, name)) continue;
      const Handle group = hdf5::open_group(open, name);
      const std::vector<double> converged = numbers_of_solves(group, "converged");
      if (std::all_of(converged.begin(), converged.end(), [](double one) { return one > 0; })) continue;
      const std::vector<double> errors = numbers_of_solves(group, "estimated_error");
      const std::vector<double> sweeps = numbers_of_solves(group, "sweeps");
      sentence +=
          fmt::format("{}not converged{}: estimated error {:.2e} after {} sweeps", sentence.empty() ? "" : "; ",
                      std::string_view(name) == "solver" ? "" : " as independent columns",
                      *std::max_element(errors.begin(), errors.end()), *std::max_element(sweeps.begin(), sweeps.end()));
    }
    return sentence;
  } catch (const hdf5::Error& error) {
    throw InputError(fmt::format("{}: can't be read ({})", file.string(), error.what()));
  }
}

}  // namespace cloudbow
