// SPDX-License-Identifier: MIT
// Options of [[body]].
#include "scene_sections.hpp"

namespace spume {

Section body_section() {
  using B = BodyDraft;
  return repeated_section<B>("body", &Draft::bodies)
      .option("name", &B::name, "name, by which [[liquid]] refers to the body")
      .absent("body.<number>, from 0")
      .word("shape", &B::kind,
            {{"box", BodyKind::box},
             {"ball", BodyKind::ball},
             {"cylinder", BodyKind::cylinder},
             {"cone", BodyKind::cone},
             {"capsule", BodyKind::capsule},
             {"ellipsoid", BodyKind::ellipsoid},
             {"half-space", BodyKind::half_space},
             {"outline", BodyKind::outline}},
            "shape, in 2-D its section: disc, rectangle, ...; or where, or mesh")
      .absent("given by where or mesh")
      .option("where", &B::where,
              "expression of x y z, positive inside the shape, as far as the domain; a bed goes around periodic sides")
      .absent("given by shape or mesh")
      .option("mesh", &B::mesh, "closed triangle mesh: .stl, .obj, .ply or .ply.gz file beside the case (3-D)")
      .beside_case()
      .absent("given by shape or where")
      .option("size", &B::size, "length", "box: lengths of its edges")
      .elsewhere({"lower", "upper"})
      .absent("not a box")
      .option("radius", &B::radius, "length", positive(),
              "ball, cylinder, capsule: radius; cone: radius of its base, at the lower end")
      .absent("not round")
      .option("top_radius", &B::top_radius, "length", not_negative(), "cone: radius at the upper end; 0: a tip")
      .absent("0")
      .option("length", &B::length, "length", positive(),
              "cylinder, cone along the last axis; capsule between the centres of its caps; outline along y (3-D)")
      .absent("without end, of a cylinder or an outline")
      .option("semi_axes", &B::semi_axes, "length", "ellipsoid: half its lengths along the axes")
      .absent("not an ellipsoid")
      .option("normal", &B::normal, "half-space: direction out of the solid")
      .absent("up")
      .option("points", &B::points, "length", "outline: corners x and height (y in 2-D, z in 3-D), in order")
      .absent("not an outline")
      .option("position", &B::position, "length",
              "where the centre stands, or the origin of an outline, an expression or a mesh; on the face of a "
              "half-space")
      .elsewhere({"centre", "center", "lower", "upper"})
      .absent("the origin")
      .option("rotation", &B::rotation, "degree",
              "about the position: one angle in 2-D; three in 3-D, about the fixed axes x, then y, then z")
      .or_one_alone()
      .absent("none")
      .option("scale", &B::scale, "1", positive(), "factor on all lengths of the shape, as from mm to m for a mesh")
      .option("inside", &B::inside, "true: the solid is inside the shape; false: outside it, and the liquid inside")
      .option("subtract", &B::subtract, "take the solid away from the bodies before it, in place of adding it to them")
      .word("wall", &B::wall,
            {{"free-slip", BoundaryKind::free_slip}, {"no-slip", BoundaryKind::no_slip}, {"none", BoundaryKind::open}},
            "condition on its surface; none: no wall, a shape for [[liquid]] to fill")
      .option("velocity", &B::velocity, "length/time",
              "velocity of the surface along itself, as of a turning cylinder: expressions of x y z t")
      .absent("it stands still")
      .option("displacement", &B::displacement, "length",
              "way from where it stands, as the body moves: expressions of t; its pictures are those of t = 0")
      .absent("it does not move")
      .option("angle", &B::angle, "degree", "by which it turns about the pivot: expression of t")
      .absent("it does not turn")
      .option("axis", &B::axis, "direction that it turns about, by the right hand (3-D)")
      .absent("in 2-D out of the plane")
      .option("pivot", &B::pivot, "length", "point that it turns about; of a floating body its centre of mass")
      .absent("the position; of a floating body the centroid")
      .option("motion", &B::motion,
              "CSV file with columns t and x, y, z (displacement) or angle, smooth between its rows")
      .beside_case()
      .absent("given by displacement and angle")
      .option(
          "release_interval", &B::release_interval, "time", positive(),
          "copies of it set out one after another, a time apart, each with displacement and angle of the time since "
          "then, as bubbles from an orifice")
      .absent("it is one body")
      .option("release_duration", &B::release_duration, "time", positive(),
              "how long each of them is on its way before it is taken away")
      .absent("required with release_interval")
      .option("release_delay", &B::release_delay, "time", not_negative(), "when the first of them sets out")
      .absent("0")
      .option("release_growth", &B::release_growth, "time", not_negative(),
              "how long each of them grows to its size, fast at first; 0: it is whole where it appears")
      .absent("0")
      .option("release_shrinkage", &B::release_shrinkage, "time", not_negative(),
              "how long each of them shrinks before it is taken away, as a bubble that bursts at the surface; 0: it is "
              "whole until then")
      .absent("0")
      .option("moves_with", &B::moves_with, "name of a body before it with which it moves as one")
      .absent("it moves alone")
      .option("mass", &B::mass, "mass", positive(), "makes it float: mass, in 2-D per length")
      .absent("it does not float, unless density is given")
      .option("density", &B::density, "density", positive(), "in place of mass: that of a uniform floating body")
      .absent("it does not float, unless mass is given")
      .option("inertia", &B::inertia, "mass length^2",
              "of a floating body about its centre of mass: one number in 2-D, three about x, y, z in 3-D")
      .or_one_alone()
      .absent("that of a uniform body")
      .option("free", &B::free,
              "motions that a floating body is free in: of \"x\", \"y\", \"z\", and \"turn\" in 2-D, \"turn_x\", "
              "\"turn_y\", "
              "\"turn_z\" in 3-D")
      .or_one_alone()
      .absent("all")
      .option("restitution", &B::restitution, "1", between(0, 1),
              "of a floating body that hits a wall or another body: speed apart over speed of approach")
      .absent("0: it does not bounce")
      .whole_only(uses_particles);
}

}  // namespace spume
