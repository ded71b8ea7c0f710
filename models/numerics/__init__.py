"""What two machines share; knows no machine."""
