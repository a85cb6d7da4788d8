//! Every diagnostic's code, in one table.

use crate::diagnostics::Severity;

macro_rules! codes {
    ($($name:ident = $code:literal $severity:ident $title:literal;)*) => {
        /// Stable code of a diagnostic.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code {
            $(#[doc = $title] $name,)*
        }

        impl Code {
            /// All codes, in order.
            pub const ALL: &[Code] = &[$(Code::$name),*];

            /// The code as printed: `E0101`.
            pub fn as_str(self) -> &'static str {
                match self { $(Code::$name => $code),* }
            }

            /// What kind of finding it is, in a few words.
            pub fn title(self) -> &'static str {
                match self { $(Code::$name => $title),* }
            }

            /// The page of `docs/errors` about it; a code without a page does not compile.
            pub fn page(self) -> &'static str {
                match self { $(Code::$name => include_str!(concat!("../../../../docs/errors/", $code, ".md"))),* }
            }

            /// Error or warning.
            pub fn severity(self) -> Severity {
                match self { $(Code::$name => Severity::$severity),* }
            }
        }
    };
}

codes! {
    // 00: files
    UnreadableFile    = "E0001" Error "a file cannot be read";
    CyclicUse         = "E0002" Error "files use each other in a circle";
    OutsideProject    = "E0003" Error "a `use` leaves the project folder";
    LimitExceeded     = "E0004" Error "a stated limit is exceeded";
    WrongTable        = "E0005" Error "a table is not what its use says";
    // 01: text
    Syntax            = "E0101" Error "the text is not in the language";
    // 02: names
    UnknownName       = "E0201" Error "a name is not defined";
    DuplicateName     = "E0202" Error "a name is defined twice";
    WrongKind         = "E0203" Error "a name means another kind of thing";
    // 03: dimensions and values
    WrongDimension    = "E0301" Error "a value has the wrong dimension";
    WrongArguments    = "E0302" Error "a call has the wrong arguments";
    EmptyRange        = "E0303" Error "a range is empty";
    NotConstant       = "E0304" Error "a value must not depend on a motion or a surface parameter";
    NotANumber        = "E0305" Error "a value is not a finite number";
    MissingValue      = "E0306" Error "a parameter has no value";
    OutOfRange        = "E0307" Error "a value lies outside its range";
    BrokenProfile     = "E0308" Error "the segments of a profile do not make one run";
    Unmet             = "E0309" Error "a requirement does not hold";
    Unproven          = "E0310" Error "an integral, a root or a point cannot be proven";
    // 04: machines
    CyclicFrames      = "E0401" Error "frames hang on each other in a circle";
    NotRigid          = "E0402" Error "a matrix is not a rigid motion";
    CyclicExtends     = "E0403" Error "machines extend each other in a circle";
    FrameTree         = "E0404" Error "the frames are not one tree";
    NcWord            = "E0405" Error "an NC word is not one axis";
    OpenLoop          = "E0406" Error "a loop does not close in one way";
    // 05: jobs
    UndrivenAxis      = "E0501" Error "an axis is not driven";
    DrivenTwice       = "E0502" Error "an axis is driven twice";
    NoSurface         = "E0503" Error "a job makes no surface";
    NotMounted        = "E0504" Error "a tool is not mounted on any frame";
    SteelSide         = "E0505" Error "the side of the steel is not one side";
    SampleShape       = "E0506" Error "a sample does not say which points are wanted";
    NoJob             = "E0507" Error "there is no such job";
    UnrelatedFrames   = "E0508" Error "two frames have no pose to each other";
    IdleMotion        = "E0509" Error "a motion does not move the tool against the work";
    FreeMotion        = "E0510" Error "a motion moves the tool, but the envelope is not over it";
    CyclicCouple      = "E0511" Error "axes follow each other in a circle";
    Trim              = "E0512" Error "a surface cannot be trimmed by this one";
    Cut               = "E0513" Error "a surface cannot be cut by these edges";
    UnevenLists       = "E0514" Error "two lists that belong together are not of one length";
    Contact           = "E0515" Error "two flanks cannot be in contact";
    Solid             = "E0516" Error "a solid is not a body";
    Want              = "E0517" Error "a contact cannot be wanted so";
    Milling           = "E0520" Error "a surface cannot be milled so";
    // 06: tests
    Expectation       = "E0601" Error "an expectation is not one that can be checked";
    // warnings
    UnusedParameter   = "W0001" Warning "a parameter is not used";
    UnusedMotion      = "W0002" Warning "a motion moves nothing";
    UnreachedFrame    = "W0003" Warning "a frame carries nothing";
    Sliding           = "W0004" Warning "with these values, a motion lets the tool slide within itself";
    EmptyFile         = "W0005" Warning "a file declares nothing";
    NeverFails        = "W0006" Warning "an expectation can never fail";
    AngleProduct      = "W0007" Warning "an angle times an angle stands where an angle is wanted";
}
