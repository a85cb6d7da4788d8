//! Compiles the generated parser.

fn main() {
    println!("cargo:rerun-if-changed=src");
    cc::Build::new().include("src").file("src/parser.c").warnings(false).std("c11").compile("tree-sitter-chain");
}
