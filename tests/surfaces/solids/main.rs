//! Bodies: closed, on the exact surfaces, with the volume of closed forms.

mod asked;
mod gauges;
mod grooves;
mod meshes;
mod parts;
mod refused;
mod spur;
mod uncut;
mod volumes;
