//! The arguments of `flank mesh`.

use std::path::PathBuf;

use clap::Args;
use flank::{BrickFormat, ElementOrder};

use super::choice::described;
use super::{EvaluatorArguments, JobArguments, folder};

#[derive(Args, Debug)]
#[command(after_help = "\
A tooth goes from the middle of a space to the middle of the next. Sets of nodes and of faces: FLANK_, FILLET_, ROOT_ and CHAMFER_ with the
surface's name (and _T2 of the second tooth where there are several), the segments of the blank by their names, SIDE_1 and SIDE_2, whose
nodes are the same turned by the meshed teeth, or of a rack shifted by them.

Examples:
  flank mesh specs/bevel/pinion_19x62.chain
  flank mesh specs/bevel/pinion_19x62.chain --teeth 3 --order 2 --format inp,vtu
  flank mesh specs/pairs/spur_pair.chain --teeth all --elements 6,8,5")]
pub(crate) struct Mesh {
    #[command(flatten)]
    pub(crate) which: JobArguments,
    /// How many neighbouring teeth, or all
    #[arg(long, value_name = "COUNT", value_parser = teeth, default_value = "1")]
    pub(crate) teeth: Teeth,
    /// Bricks up a flank, along the tooth, and from flank to flank; those at fillets, root and rim follow
    #[arg(long, value_name = "PROFILE,LENGTH,THICKNESS", value_parser = elements, default_value = "8,12,6")]
    pub(crate) elements: [u32; 3],
    /// The order of their shape functions
    #[arg(long, value_parser = described::<ElementOrder>(), default_value = "1")]
    pub(crate) order: ElementOrder,
    /// Folder for the files; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "build", value_parser = folder())]
    pub(crate) out: PathBuf,
    /// Files with the bricks, several with commas
    #[arg(long, value_parser = described::<BrickFormat>(), value_delimiter = ',', default_value = "inp")]
    pub(crate) format: Vec<BrickFormat>,
    /// Print the numbers as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) evaluator: EvaluatorArguments,
}

/// So many teeth; none says all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Teeth(pub(crate) Option<u32>);

fn teeth(text: &str) -> Result<Teeth, String> {
    match text.trim() {
        "all" => Ok(Teeth(None)),
        number => number
            .parse()
            .ok()
            .filter(|count| *count > 0)
            .map(|count| Teeth(Some(count)))
            .ok_or("write a whole number from 1 on, or all".to_string()),
    }
}

/// The fewest and the most of each.
const LIMITS: [(u32, u32); 3] = [(1, 500), (1, 10_000), (3, 500)];

fn elements(text: &str) -> Result<[u32; 3], String> {
    let numbers: Vec<u32> = text.split(',').map_while(|number| number.trim().parse().ok()).collect();
    <[u32; 3]>::try_from(numbers)
        .ok()
        .filter(|numbers| text.split(',').count() == 3 && numbers.iter().zip(LIMITS).all(|(of, (low, high))| (low..=high).contains(of)))
        .ok_or_else(|| {
            let [profile, length, thickness] = LIMITS.map(|(low, high)| format!("{low} to {high}"));
            format!("write three whole numbers, for example 8,12,6: up a flank {profile}, along the tooth {length}, from flank to flank {thickness}")
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_bricks_are_three() {
        assert_eq!(elements("8, 12,6"), Ok([8, 12, 6]));
        for wrong in ["8", "8,12", "8,12,6,1", "0,12,6", "8,12,2", "8,12,x", "", "8,12,6x"] {
            assert!(elements(wrong).is_err(), "{wrong}");
        }
        assert_eq!(teeth("all"), Ok(Teeth(None)));
        assert_eq!(teeth("3"), Ok(Teeth(Some(3))));
        assert!(teeth("0").is_err() && teeth("-1").is_err() && teeth("few").is_err());
    }
}
