# instrument.pl TABLE FOLDER -- in FOLDER (a copy of the tree's rooms) the broken text of each place of the table stands behind a switch: where
# rigtwin_broken is the number of its line. Prints the names in their order. How lines are broken and indented does not count.
use strict;
use warnings;

# A pattern for a text, whatever its blanks.
sub pattern { return join('\s+', map { quotemeta } split(/\s+/, $_[0], -1)) }

my ($table, $folder) = @ARGV;
my %texts;
my $number = 0;
open(my $list, '<', $table) or die "$table: $!";
while (my $line = <$list>) {
  next if $line =~ /^#|^\s*$/;
  chomp $line;
  my ($name, $file, $text, $instead) = map { s/\\\|/|/gr } split(/ (?<!\\)\| /, $line);
  die "$table:$.: expected NAME | FILE | TEXT with [[broken]] | INSTEAD\n"
    unless defined $instead && $text =~ /^(.*?)\[\[(.*)\]\](.*)$/;
  my ($before, $sound, $after) = ($1, $2, $3);
  ++$number;
  unless (exists $texts{$file}) {
    open(my $in, '<', "$folder/$file") or die "$file: $!";
    local $/;
    $texts{$file} = <$in>;
  }
  my $pattern = '(' . pattern($before) . ')' . pattern($sound) . '(' . pattern($after) . ')';
  my $count = () = $texts{$file} =~ /$pattern/g;
  $count /= 2;  # two groups each
  die "$table:$.: the text of $name stands $count times in $file, expected once\n" unless $count == 1;
  my $operator = $sound =~ /^(&&|\|\|) / ? "$1 " : '';  # behind which the sound text goes on
  $sound =~ s/^(&&|\|\|) //;
  $instead =~ s/^(&&|\|\|) //;
  my $both = $instead =~ /RIGTWIN_NUMBER/ ? $instead =~ s/RIGTWIN_NUMBER/$number/r
                                          : "$operator(rigtwin_broken == $number ? ($instead) : ($sound))";
  $texts{$file} =~ s/$pattern/$1$both$2/;
  print "$name\n";
}
for my $file (keys %texts) {
  open(my $out, '>', "$folder/$file") or die "$file: $!";
  print $out $texts{$file} =~ s/(#include)/#include "tests\/faults\/broken\/broken.hpp"\n$1/r;
}
