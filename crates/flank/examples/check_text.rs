//! A spec that is no file is checked, as an editor checks what is being typed.

use std::sync::Arc;

use flank::{Buffers, Disk, Project, check};

fn main() {
    let text = "machine lathe {\n    axis C : rotary\n    frame bed\n    frame work in bed = rotate_z(B)\n}\n";
    let files = Buffers::over(Arc::new(Disk)).with("lathe.chain".as_ref(), text);
    let checked = check(&Project::open("lathe.chain", Arc::new(files)));
    for finding in checked.findings.list() {
        println!("{}:{}: {} {}", finding.place.line, finding.place.column, finding.code, finding.message);
    }
    print!("{}", checked.findings.rendered(false));
}
