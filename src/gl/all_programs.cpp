#include "src/gl/all_programs.h"

#include "src/gl/march_passes.h"
#include "src/gl/projection_passes.h"
#include "src/gl/segment_lists.h"
#include "src/gl/slabs.h"
#include "src/gl/slice_programs.h"
#include "src/gl/table_maker.h"
#include "src/gl/walk_passes.h"

namespace tetravox::gl {
namespace {

void add_walk(std::vector<ProgramRecipe>& programs) {
  programs.push_back({"lists", recipe_of_lists()});
  programs.push_back({"peeling", recipe_of_peeling()});
  programs.push_back({"sorting", {recipe_of_sorting()}});
  for (const EntryOrder order : {EntryOrder::kLists, EntryOrder::kPeeling})
    for (const bool is_behind_eye : {false, true})
      for (const IntegratorShader& integrator : all_integrator_shaders()) {
        const WalkVariant variant{integrator.name == "cell data", is_behind_eye, order};
        programs.push_back({"walk by " + name_of(order) + ", " + integrator.name + (is_behind_eye ? ", behind" : ""),
                            {recipe_of_walk(integrator, variant)}});
      }
}

void add_projection(std::vector<ProgramRecipe>& programs) {
  for (const bool has_cell_data : {false, true})
    for (const bool use_outlines : {false, true})
      programs.push_back({"decomposition", {recipe_of_decomposition(has_cell_data, use_outlines)}});
  programs.push_back({"lists, sorting", {recipe_of_segment_sorting()}});
  for (const IntegratorShader& integrator : all_integrator_shaders()) {
    const bool has_cell_data = integrator.name == "cell data";
    programs.push_back({"lists, " + integrator.name, {recipe_of_resolving(integrator, has_cell_data)}});
    for (const bool is_orthographic : {false, true})
      for (const bool fills_lists : {false, true})
        for (const bool use_outlines : {false, true}) {
          const ProjectionShader shader{integrator, has_cell_data, is_orthographic, fills_lists, use_outlines};
          programs.push_back({"project, " + integrator.name, recipe_of_projection(shader)});
          if (!use_outlines) programs.push_back({"vicp, " + integrator.name, recipe_of_vicp(shader)});
        }
  }
}

void add_slices(std::vector<ProgramRecipe>& programs) {
  programs.push_back({"slices, box", recipe_of_box()});
  programs.push_back({"slices, filter", recipe_of_filter()});
  programs.push_back({"slices, stack", {recipe_of_stack()}});
  programs.push_back({"slices, gradients", {recipe_of_gradients()}});
  for (const SliceVariant& variant : slice_variants())
    for (const IntegratorShader& integrator : all_integrator_shaders()) {
      const bool is_segment = variant.classification == SliceClassification::kSegment;
      if (is_segment &&
          (integrator.name == "cell data" || integrator.name == "post" || integrator.name == "cylindrical"))
        continue;
      if (!is_segment && integrator.name != "post") continue;  // looks nothing up
      const std::string key = key_of(integrator, variant);
      programs.push_back({"slab " + key, recipe_of_slab(integrator, variant)});
      if (variant.is_half_angle) programs.push_back({"light " + key, recipe_of_light(integrator, variant)});
    }
}

}  // namespace

std::vector<ProgramRecipe> all_programs() {
  std::vector<ProgramRecipe> programs;
  add_walk(programs);
  add_projection(programs);
  for (const MarchKind& kind : march_kinds())
    programs.push_back({"march, " + kind.shader.name, {recipe_of_march(kind)}});
  for (const IntegratorShader& integrator : slab_filling_shaders())
    programs.push_back({"slabs, " + integrator.name, {recipe_of_slabs(integrator)}});
  for (const auto& [name, stages] : recipes_of_tables()) programs.push_back({"tables, " + name, stages});
  add_slices(programs);
  return programs;
}

}  // namespace tetravox::gl
