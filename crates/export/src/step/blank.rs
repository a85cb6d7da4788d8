//! Faces and edges of a blank: what the segments and corners of its outline pass over.

use super::real;
use super::shell::{Edge, Shell};
use super::solid::{GearRun, LEAST_UNCERTAINTY, TurnedSegment};
use crate::files::error::WriteError;
use crate::vector::Vector;

impl Shell<'_, '_, '_> {
    pub(super) fn straight(&mut self, vertices: [usize; 2], [from, to]: [Vector; 2]) -> Result<Edge, WriteError> {
        let along = [0, 1, 2].map(|k| to[k] - from[k]);
        let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
        let (point, direction) = (self.part.point(from)?, self.part.direction(along.map(|x| x / length))?);
        let vector = self.part.add(&format!("VECTOR('',#{direction},1.)"))?;
        let line = self.part.add(&format!("LINE('',#{point},#{vector})"))?;
        self.edge(vertices, line)
    }

    /// What a place of the outline passes over: part of a circle about the axis, or a line.
    pub(super) fn path(&mut self, vertices: [usize; 2], place: [f64; 2]) -> Result<Edge, WriteError> {
        let [z, rho] = place;
        if let GearRun::Straight { .. } = self.body.run {
            return self.straight(vertices, [[rho, 0.0, z], [rho, 1.0, z]]);
        }
        let place = self.part.placement([0.0, 0.0, z], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])?;
        let circle = self.part.add(&format!("CIRCLE('',#{place},{})", real(rho)))?;
        self.edge(vertices, circle)
    }

    /// The segment itself, so far on: in the half plane at an angle, or across y.
    pub(super) fn seam(&mut self, segment: &TurnedSegment, vertices: [usize; 2], way: f64) -> Result<Edge, WriteError> {
        let run = self.body.run;
        let [from, to] = [segment.from, segment.to];
        let Some(center) = segment.center else {
            return self.straight(vertices, [run.at(from, way), run.at(to, way)]);
        };
        let [out, to] = [from, to].map(|end| [end[0] - center[0], end[1] - center[1]]);
        let radius = out[0].hypot(out[1]);
        let turn = (out[0] * to[1] - out[1] * to[0]).signum();
        let [outwards, on] = run.directions(way);
        // from z to rho is a turn about the direction of the way
        let axis = on.map(|x| turn * x);
        let reference = [0, 1, 2].map(|k| (outwards[k] * out[1] + if k == 2 { out[0] } else { 0.0 }) / radius);
        let place = self.part.placement(run.at(center, way), axis, reference)?;
        let circle = self.part.add(&format!("CIRCLE('',#{place},{})", real(radius)))?;
        self.edge(vertices, circle)
    }

    /// The surface that a segment passes over, its seam so far on, and whether its own normal points out of the body.
    pub(super) fn surface(&mut self, segment: &TurnedSegment, seam: f64) -> Result<(usize, bool), WriteError> {
        if let GearRun::Straight { .. } = self.body.run {
            return self.extruded(segment);
        }
        let [from, to] = [segment.from, segment.to];
        let (dz, drho) = (to[0] - from[0], to[1] - from[1]);
        let up = [0.0, 0.0, 1.0];
        let reference = [seam.cos(), seam.sin(), 0.0];
        let on_axis = |z: f64| [0.0, 0.0, z];
        if let Some(center) = segment.center {
            return self.turned_arc(segment, center, reference);
        }
        // outside is on the right
        if is_plane(segment) {
            let place = self.part.placement(on_axis(from[0]), up, reference)?;
            return Ok((self.part.add(&format!("PLANE('',#{place})"))?, drho > 0.0));
        }
        if drho == 0.0 {
            let place = self.part.placement(on_axis(from[0]), up, reference)?;
            return Ok((self.part.add(&format!("CYLINDRICAL_SURFACE('',#{place},{})", real(from[1])))?, dz < 0.0));
        }
        // the radius of a cone grows along its axis, and is not that of its apex
        let axis = [0.0, 0.0, (drho / dz).signum()];
        let wide = if drho > 0.0 { to } else { from };
        let place = self.part.placement(on_axis(wide[0]), axis, reference)?;
        let half = (drho / dz).abs().atan();
        let cone = format!("CONICAL_SURFACE('',#{place},{},{})", real(wide[1]), real(half));
        Ok((self.part.add(&cone)?, dz < 0.0))
    }

    /// The sphere or the torus that an arc passes over.
    fn turned_arc(
        &mut self,
        segment: &TurnedSegment,
        [z, rho]: [f64; 2],
        reference: Vector,
    ) -> Result<(usize, bool), WriteError> {
        let [out, to] = [segment.from, segment.to].map(|end| [end[0] - z, end[1] - rho]);
        let (major, minor) = (rho.abs(), out[0].hypot(out[1]));
        // an arc that turns left bulges out of the material
        let is_outward = out[0] * to[1] - out[1] * to[0] > 0.0;
        let place = self.part.placement([0.0, 0.0, z], [0.0, 0.0, 1.0], reference)?;
        // readers take points for one that are farther apart than sphere and torus
        if major < LEAST_UNCERTAINTY {
            return Ok((self.part.add(&format!("SPHERICAL_SURFACE('',#{place},{})", real(minor)))?, is_outward));
        }
        let radii = format!("#{place},{},{}", real(major), real(minor));
        if minor < major {
            return Ok((self.part.add(&format!("TOROIDAL_SURFACE('',{radii})"))?, is_outward));
        }
        // a torus that crosses the axis: outside the arc's centre lies on its side of that, inside beyond it, where the normal is turned
        let is_outer = rho > 0.0;
        let side = if is_outer { ".T." } else { ".F." };
        let surface = self.part.add(&format!("DEGENERATE_TOROIDAL_SURFACE('',{radii},{side})"))?;
        Ok((surface, is_outward == is_outer))
    }

    /// The plane or the cylinder along y over a segment.
    fn extruded(&mut self, segment: &TurnedSegment) -> Result<(usize, bool), WriteError> {
        let [[z, x], to] = [segment.from, segment.to];
        let along_y = [0.0, 1.0, 0.0];
        if let Some([center_z, center_x]) = segment.center {
            let radius = (z - center_z).hypot(x - center_x);
            let place = self.part.placement([center_x, 0.0, center_z], along_y, [1.0, 0.0, 0.0])?;
            let is_outward = (z - center_z) * (to[1] - center_x) - (x - center_x) * (to[0] - center_z) > 0.0;
            return Ok((self.part.add(&format!("CYLINDRICAL_SURFACE('',#{place},{})", real(radius)))?, is_outward));
        }
        let length = (to[0] - z).hypot(to[1] - x);
        // outside is on the right
        let normal = [-(to[0] - z) / length, 0.0, (to[1] - x) / length];
        let place = self.part.placement([x, 0.0, z], normal, along_y)?;
        Ok((self.part.add(&format!("PLANE('',#{place})"))?, true))
    }
}

pub(super) fn is_plane(segment: &TurnedSegment) -> bool {
    segment.center.is_none() && segment.from[0] == segment.to[0]
}
