// SPDX-License-Identifier: MIT
#include "spume/scene/load.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "bodies.hpp"
#include "body_motion.hpp"
#include "box_bodies.hpp"
#include "checks.hpp"
#include "fill.hpp"
#include "motion_checks.hpp"
#include "open_sides.hpp"
#include "openings.hpp"
#include "reader.hpp"
#include "releases.hpp"
#include "resolved.hpp"
#include "slots.hpp"
#include "spume/core/machine.hpp"
#include "spume/scene/expression.hpp"
#include "spume/scene/find_case.hpp"
#include "spume/scene/solid_union.hpp"
#include "translate.hpp"
#include "unused_options.hpp"
#include "wavemakers.hpp"

namespace spume {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t largest_file = 16u << 20;  // a case is text of some kB: what is larger is another file

std::string read_text(const std::string& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) throw InputError("'" + file + "' is not a file");
  if (fs::file_size(file, error) > largest_file)
    throw InputError("'" + file + "' is larger than 16 MiB, too large for a case");
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw InputError("cannot read '" + file + "': " + std::strerror(errno));
  return std::move(text).str();
}

std::string name_of_case(const std::string& file) {
  const fs::path path(file);
  if (path.filename() != "case.toml") return path.stem().string();
  std::error_code ignored;
  return fs::absolute(path, ignored).parent_path().filename().string();
}

// Compiles expressions and reports their faults at their place.
class Compiler {
 public:
  Compiler(int dimensions, const std::string& source, Problems& problems)
      : scope_(dimensions), source_(source), problems_(problems) {}

  void define_constants(const Node* table) {
    if (!table || table->kind != Node::Kind::table) return;
    std::vector<std::pair<std::string, std::string>> constants;
    std::vector<const Node*> nodes;
    for (std::size_t i = 0; i < table->keys.size(); ++i) {
      const Node& node = table->children[i];
      if (node.kind != Node::Kind::string && !node.is_number()) {
        problems_.add(
            node, "constants." + table->keys[i] + " must be a number or an expression, found " + kind_in_words(node));
        continue;
      }
      constants.emplace_back(table->keys[i], node.kind == Node::Kind::string ? node.text : to_toml(node));
      nodes.push_back(&node);
    }
    for (const auto& fault : scope_.define(constants)) {
      const std::string text = "constants." + constants[fault.constant].first + ": " + fault.text;
      if (fault.position == std::string::npos)
        problems_.add_key(*nodes[fault.constant], text);
      else
        problems_.add_in_string(*nodes[fault.constant], fault.position, text, source_);
    }
  }

  std::shared_ptr<const Expression> compile(const ExpressionText& text, const std::string& name,
                                            Arguments arguments = Arguments::place_and_time) {
    try {
      return scope_.compile(text.text, arguments);
    } catch (const ExpressionError& error) {
      problems_.add_in_string(*text.node, error.position(), name + ": " + error.what(), source_);
      return nullptr;
    }
  }

  // Components that are zero everywhere are left out.
  VectorExpression compile(const std::vector<ExpressionText>& texts, const std::string& name,
                           Arguments arguments = Arguments::place_and_time) {
    VectorExpression vector;
    for (std::size_t a = 0; a < texts.size() && a < 3; ++a) {
      const auto component = compile(texts[a], name + "[" + std::to_string(a) + "]", arguments);
      if (component && constant_value(*component) != 0.0) vector.component[a] = component;
    }
    return vector;
  }

  // In a spectrum k is the wavenumber, whatever the case calls k elsewhere: it takes the place of x.
  std::shared_ptr<const Expression> compile_spectrum(const ExpressionText& text) {
    const ExpressionScope plain = scope_;
    scope_.define({{"k", "x"}});
    auto spectrum = compile(text, "initial.spectrum", Arguments::place);
    scope_ = plain;
    return spectrum;
  }

  const ExpressionScope& scope() const { return scope_; }

 private:
  ExpressionScope scope_;
  const std::string& source_;
  Problems& problems_;
};

bool any(const VectorExpression& vector) {
  return vector.component[0] || vector.component[1] || vector.component[2];
}

Domain make_domain(const Draft& draft, Compiler& compiler) {
  Domain domain;
  domain.dimensions = draft.dimensions;
  domain.lower = to_vec3(draft.lower);
  domain.upper = to_vec3(draft.upper);
  for (int axis = 0; axis < draft.dimensions; ++axis) {
    const auto names = side_names(axis, draft.dimensions);
    for (std::size_t end = 0; end < 2; ++end) {
      Side& side = domain.sides[static_cast<std::size_t>(axis)][end];
      if (draft.periodic[static_cast<std::size_t>(axis)])
        side.kind = BoundaryKind::periodic;
      else if (draft.sides.count(names[end]))
        side.kind = draft.sides.at(names[end]);
      const auto velocity = draft.wall_velocity.find(names[end]);
      if (velocity == draft.wall_velocity.end()) continue;
      VectorExpression moving = compiler.compile(velocity->second, "domain.wall_velocity." + names[end]);
      if (any(moving)) side.velocity = std::move(moving);
    }
  }
  for (const SolidDraft& solid : draft.solids) {
    domain.boxes.push_back({to_vec3(solid.lower), to_vec3(solid.upper), solid.wall});
  }
  return domain;
}

Fluid make_fluid(const Draft& draft) {
  const FluidDraft& given = draft.fluid;
  Fluid fluid;
  double gravity = 0;
  if (!draft.phases.empty()) {
    const Phase& first = draft.phases.front();
    fluid.density = first.density;
    fluid.kinematic_viscosity = first.viscosity / first.density;
    fluid.sound_speed = first.sound_speed;
    gravity = given.froude ? 1 / (*given.froude * *given.froude) : given.gravity.value_or(0);
  } else if (uses_si(given)) {
    fluid.density = given.density.value_or(1);
    fluid.kinematic_viscosity = given.viscosity.value_or(0) / fluid.density;
    fluid.sound_speed = given.sound_speed.value_or(0);
    gravity = given.gravity.value_or(0);
  } else {
    fluid.kinematic_viscosity = given.reynolds ? 1 / *given.reynolds : 0;
    fluid.sound_speed = given.mach && *given.mach > 0 ? 1 / *given.mach : 0;
    gravity = given.froude ? 1 / (*given.froude * *given.froude) : 0;
  }
  if (gravity > 0) fluid.gravity[static_cast<std::size_t>(draft.dimensions) - 1] = -gravity;
  return fluid;
}

void set_grid(Scene& scene, const std::vector<std::int64_t>& grid) {
  scene.spacing = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < 3; ++a) {
    scene.grid[a] = static_cast<std::size_t>(grid[grid.size() == 1 ? 0 : a]);
    const double length = scene.domain.upper[a] - scene.domain.lower[a];
    scene.spacing = std::min(scene.spacing, length / static_cast<double>(scene.grid[a]));
  }
}

LiquidRegion make_region(const Draft& draft, const LiquidDraft& given, const std::string& name,
                         const std::vector<Body>& bodies, Compiler& compiler) {
  LiquidRegion region;
  region.name = name;
  region.node = draft.node(name);
  if (given.where) region.where = compiler.compile(*given.where, name + ".where", Arguments::place);
  region.lower = to_vec3(given.lower.empty() ? draft.lower : given.lower);
  region.upper = to_vec3(given.upper.empty() ? draft.upper : given.upper);
  region.ball = !given.centre.empty() && given.radius;
  if (region.ball) {
    region.centre = to_vec3(given.centre);
    region.radius = *given.radius;
  }
  for (const Body& body : bodies)
    if (body.name == given.body && body.shape) {
      region.body = body.shape;
      const Bounds bounds = body.shape->bounds();
      for (std::size_t a = 0; a < static_cast<std::size_t>(draft.dimensions); ++a) {
        region.lower[a] = std::max(region.lower[a], bounds.lower[a]);
        region.upper[a] = std::min(region.upper[a], bounds.upper[a]);
      }
    }
  region.velocity = compiler.compile(given.velocity, name + ".velocity", Arguments::place);
  region.conform = given.conform;
  return region;
}

std::vector<LiquidRegion> make_regions(const Draft& draft, const std::vector<Body>& bodies, Compiler& compiler) {
  std::vector<LiquidRegion> regions;
  for (std::size_t k = 0; k < draft.liquids.size(); ++k)
    regions.push_back(make_region(draft, draft.liquids[k], "liquid." + std::to_string(k), bodies, compiler));
  for (std::size_t k = 0; k < draft.regions.size(); ++k) {
    regions.push_back(make_region(draft, draft.regions[k], "region." + std::to_string(k), bodies, compiler));
    const auto phase = std::find_if(draft.phases.begin(), draft.phases.end(),
                                    [&](const Phase& one) { return one.name == draft.regions[k].phase; });
    regions.back().phase = static_cast<std::int32_t>(phase - draft.phases.begin());
  }
  return regions;
}

CompileExpression compile_with(Compiler& compiler) {
  return [&](const ExpressionText& text, const std::string& name, Arguments arguments) {
    return compiler.compile(text, name, arguments);
  };
}

// What the method's sections make of their expressions.
void compile_sections(const CaseSchema& schema, Draft& draft, Compiler& compiler) {
  const MethodDeclaration* method = schema.find(draft.options.method);
  const CompileExpression compile = compile_with(compiler);
  for (const Section& section : schema.sections())
    if (section.compile && section.owners.include(method == nullptr ? std::string() : method->name))
      section.compile(draft, compile);
}

// Where the case gives what, below `name`.
void note_places(const Node& node, const std::string& name, const std::string& file,
                 std::map<std::string, Problem>& places) {
  if (!name.empty())
    places[name] = node.override_text.empty() ? Problem{file, node.place.line, node.place.column, {}}
                                              : Problem{node.override_text, 0, 0, {}};
  for (std::size_t i = 0; i < node.children.size(); ++i) {
    const std::string key = node.kind == Node::Kind::table ? node.keys[i] : std::to_string(i);
    const std::string within = name.empty() ? std::string() : name + ".";
    note_places(node.children[i], within + key, file, places);
  }
}

std::vector<ProbeScalar> probe_scalars(const MethodDeclaration* method, const Case& options) {
  return method != nullptr && method->probe_scalars ? method->probe_scalars(options) : std::vector<ProbeScalar>{};
}

void check(const MethodDeclaration* method, Draft& draft, Problems& problems) {
  // A case of no known method is read as one of particles, which most are.
  const bool phases = method != nullptr && method->fills_phases;
  const bool liquids = method == nullptr || method->fills_regions;
  check_title(draft, problems);
  check_domain(draft, problems);
  if (liquids || phases) check_resolution(draft, problems);
  check_solids(draft, problems);
  check_bodies(draft, method, problems);
  check_body_motions(draft, method, problems);
  if (!phases) check_fluid(draft, problems);
  if (liquids) check_liquids(draft, problems);
  if (phases) check_phases(draft, problems);
  warn_of_kinematic_viscosity(draft, problems);
  check_wavemakers(draft, problems);
  check_sponges(draft, problems);
  check_openings(draft, problems);
  if (method != nullptr) {
    if (method->check) method->check(draft, problems);
    check_output_fields(draft, method->output_fields(draft.options), problems);
  }
  check_output(draft, problems);
  check_probes(draft, probe_scalars(method, draft.options), problems);
}

void set_grid(const Draft& draft, double most, Scene& scene, Problems& problems) {
  set_grid(scene, draft.grid);
  const double points =
      static_cast<double>(scene.grid[0]) * static_cast<double>(scene.grid[1]) * static_cast<double>(scene.grid[2]);
  if (points > most)
    problems.add(*draft.node("resolution.grid"), "the grid has " + brief(points) +
                                                     " points; this machine has memory for " + brief(most) +
                                                     ": lower resolution.grid");
}

}  // namespace

LoadedCase load_case(const std::string& path, const std::vector<std::string>& overrides, const CaseSchema& schema) {
  const std::string file = find_case_file(path);
  const std::string source = read_text(file);
  Node document = parse_document(source, file);

  Problems problems(file);
  std::vector<std::string> repeated;
  for (const Section& section : schema.sections()) {
    if (section.repeated) repeated.push_back(section.name);
  }
  for (const std::string& assignment : overrides) apply_override(document, assignment, repeated, problems);
  const Translation translation = translate(document, schema, file);

  Draft draft;
  draft.groups = translation.groups;
  draft.options.path = file;
  draft.options.title = name_of_case(file);
  read_document(document, schema, draft, problems);
  const MethodDeclaration* method = schema.find(draft.options.method);
  check(method, draft, problems);

  // Without a valid domain the expressions are still checked in three dimensions.
  Compiler compiler(draft.dimensions == 0 ? 3 : draft.dimensions, source, problems);
  compiler.define_constants(draft.node("constants"));
  LoadedCase loaded;
  Scene& scene = loaded.scene;
  scene.domain = make_domain(draft, compiler);
  // Four bytes each.
  constexpr double most_cells = 1e8;
  if (const double cells = SolidUnion::cells_needed(scene.domain); !scene.domain.boxes.empty() && cells > most_cells)
    problems.add(*draft.node("solid.0"), "the planes of all boxes cut the domain into " + brief(cells) +
                                             " cells; at most " + brief(most_cells) +
                                             " are possible: use fewer boxes, or align their faces");
  scene.bodies = make_bodies(draft, compile_with(compiler), problems);
  scene.motions = make_body_motions(draft, compile_with(compiler), draft.options.time.end, scene.bodies, problems);
  add_released(draft, scene.bodies, scene.motions, problems);
  carry_probes(draft, scene.bodies, draft.options.probes, problems);
  scene.openings = make_openings(draft, compile_with(compiler), problems);
  open_sides_at(scene.openings, scene.domain);
  const std::vector<LiquidRegion> regions = make_regions(draft, scene.bodies, compiler);
  VectorExpression body_force = compiler.compile(draft.body_force, "forces.body");
  VectorExpression initial_velocity = compiler.compile(draft.initial_velocity, "initial.velocity", Arguments::place);
  if (draft.initial_spectrum) scene.initial_spectrum = compiler.compile_spectrum(*draft.initial_spectrum);
  compile_sections(schema, draft, compiler);
  problems.throw_if_any();

  if (any(body_force)) scene.body_force = std::move(body_force);
  if (!draft.initial_velocity.empty()) scene.initial_velocity = std::move(initial_velocity);
  scene.title = draft.options.title;
  scene.method = draft.options.method;
  scene.fluid = make_fluid(draft);
  scene.phases = draft.phases;
  scene.surface_tension = draft.surface_tension;
  scene.spacing = draft.options.spacing;
  scene.seed = draft.options.seed;
  const std::vector<std::shared_ptr<const PistonMotion>> of_flaps = add_flaps(draft, scene, problems);
  if (method->solids_join_bodies && has_wall_points(scene)) make_bodies_of_boxes(scene);
  problems.throw_if_any();
  scene.walls = make_walls(scene.bodies, scene.motions);
  loaded.bytes_per_particle = method->bytes_per_particle(draft);
  const double most = machine_memory_bytes() / loaded.bytes_per_particle;
  if (method->uses_grid) set_grid(draft, most, scene, problems);
  Lattice lattice;
  if (uses_particles(*method)) {
    lattice = make_lattice(scene.domain, scene.spacing);
    fill_scene(scene, lattice, regions, draft.jitter, most, problems);
  }
  problems.throw_if_any();
  const std::vector<Wavemaker> wavemakers = make_wavemakers(draft, scene, of_flaps, problems);
  scene.sponges = make_sponges(draft, wavemakers);
  check_openings_of(draft, scene, lattice.volume(), problems);
  check_motions(draft, scene, method->incompressible, problems);
  if (uses_particles(*method)) check_released_ways(draft, scene, problems);
  double& courant = draft.options.time.courant;
  if (courant == 0) courant = method->default_courant(draft.options, scene);
  if (method->fills_phases) check_phases_filled(draft, scene, problems);
  if (!method->honours_displaced_walls) check_sliding_walls(draft, scene, method->name, problems);
  if (method->check_scene) method->check_scene(draft, scene, problems);
  problems.throw_if_any();
  if (method->solids_join_bodies && boxes_stand_in_full_domain(scene)) {
    make_bodies_of_boxes(scene);
    scene.walls = make_walls(scene.bodies, scene.motions);
  }

  loaded.probe_scalars = probe_scalars(method, draft.options);
  draft.options.groups = describe_groups(draft, scene, compiler.scope());
  if (uses_particles(*method)) describe_lattice(scene, lattice, draft.options.groups);
  describe_waves(draft, scene, wavemakers, draft.options.groups);
  note_places(document, "", file, draft.options.places);
  draft.options.resolved = resolved_text(document, schema, draft);
  draft.options.warnings = translation.warnings;
  warn_of_probes(draft, scene, problems);
  for (const Problem& warning : problems.warnings()) draft.options.warnings.push_back(warning);
  for (Problem& warning : unused_options(draft, schema, file)) draft.options.warnings.push_back(std::move(warning));
  for (Problem& warning : body_warnings(draft, scene, file)) draft.options.warnings.push_back(std::move(warning));
  for (Problem& warning : corner_warnings(draft, scene, file)) draft.options.warnings.push_back(std::move(warning));
  if (uses_particles(*method))
    for (Problem& warning : slot_warnings(draft, scene, file)) draft.options.warnings.push_back(std::move(warning));
  for (Problem& warning : release_warnings(draft, scene, file)) draft.options.warnings.push_back(std::move(warning));
  for (Problem& warning : collision_warnings(draft, scene, file)) draft.options.warnings.push_back(std::move(warning));
  if (uses_particles(*method)) {
    for (Problem& warning : open_side_warnings(draft, scene, file))
      draft.options.warnings.push_back(std::move(warning));
    for (Problem& warning : outflow_warnings(draft, scene, file)) draft.options.warnings.push_back(std::move(warning));
    for (Problem& warning : cell_warnings(scene, lattice, regions, file))
      draft.options.warnings.push_back(std::move(warning));
    for (Problem& warning : level_warnings(scene, lattice, regions, file))
      draft.options.warnings.push_back(std::move(warning));
  }
  for (Problem& warning : wave_warnings(draft, scene, wavemakers, file))
    draft.options.warnings.push_back(std::move(warning));
  loaded.options = std::move(draft.options);
  return loaded;
}

}  // namespace spume
